#pragma once

// The descriptors that the registry makes from C++ types. Included by registry.h.

#include <array>
#include <iterator>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <quiver/core/problem/dynamic_batch.h>
#include <quiver/core/problem/fixed_batch.h>
#include <quiver/core/problem/retraction.h>
#include <quiver/core/registry/value_fields.h>
#include <quiver/core/util/type_name.h>

namespace quiver::detail {

/// Fields of a type: its own list, or those of its value.
template <typename T, typename Value>
std::vector<Field> fieldsOf() {
  static_assert(ReadsItself<T> == WritesItself<T>, "a type that reads its own fields writes them too, and vice versa");
  if constexpr (requires {
                  { T::fields() } -> std::convertible_to<std::vector<Field>>;
                }) {
    return T::fields();
  } else {
    static_assert(
        requires { ValueFields<Value>::fields(); },
        "give the type fields(), read() and write(), or specialise quiver::ValueFields for its value");
    return ValueFields<Value>::fields();
  }
}

template <typename V>
class VertexTypeOf final : public VertexType {
 public:
  VertexTypeOf(std::string tag, std::string documentation)
      : VertexType(std::move(tag), typeName<V>(), std::move(documentation)) {
    static_assert(alignof(V) <= 8, "a vertex may not ask for more alignment than a double");
    static_assert(
        requires(const typename V::Estimate& x, const Vector<double, V::dimension>& delta) {
          { V::oplus(x, delta) } -> std::same_as<typename V::Estimate>;
        },
        "static oplus(estimate, Vector<double, D>) must return exactly Estimate: name the type instead of auto");
  }

  std::size_t objectSize() const override { return sizeof(V); }
  std::unique_ptr<ElementPool<Vertex>> makePool() const override { return std::make_unique<TypedPool<Vertex, V>>(); }
  std::vector<Field> fields() const override { return fieldsOf<V, typename V::Estimate>(); }
  int dimension() const override { return V::dimension; }
  int dimension(const Vertex& vertex) const override {
    return V::dimension == Dynamic ? valueCount(vertex) : V::dimension;
  }
  PoseKind poseKind() const override {
    if constexpr (std::is_same_v<typename V::Estimate, SE2<double>>) {
      return PoseKind::plane;
    } else if constexpr (std::is_same_v<typename V::Estimate, SE3<double>>) {
      return PoseKind::space;
    } else {
      return PoseKind::none;
    }
  }
  PlaceKind placeKind() const override { return placeKindOf<V>(); }
  SE3<double> place(const double* values) const override {
    if constexpr (placeKindOf<V>() == PlaceKind::none) {
      return inSpace(NoPlace());
    } else {
      return inSpace(placeOf<V>(Packing<typename V::Estimate>::template load<double>(values)));
    }
  }
  int valueCount(const Vertex& vertex) const override { return static_cast<const V&>(vertex).valueCount(); }
  const double* values(const Vertex& vertex) const override { return static_cast<const V&>(vertex).values(); }
  void setValues(Vertex& vertex, const double* values) const override {
    V& typed = static_cast<V&>(vertex);
    std::copy_n(values, typed.valueCount(), typed.values());
    typed.setHasEstimate(true);
  }
  void setToOrigin(Vertex& vertex) const override {
    V& typed = static_cast<V&>(vertex);
    if constexpr (V::dimension == Dynamic) {
      std::fill_n(typed.values(), typed.valueCount(), 0.0);
      typed.setHasEstimate(true);
    } else if constexpr (requires { V::Estimate::Zero(); }) {
      typed.setEstimate(V::Estimate::Zero());
    } else {
      typed.setEstimate(typename V::Estimate());
    }
  }

  void retract(const double* x, const double* delta, double* out, int dimension) const override {
    if constexpr (V::dimension == Dynamic) {
      const Eigen::Map<const Eigen::VectorXd> estimate(x, dimension);
      const Eigen::Map<const Eigen::VectorXd> step(delta, dimension);
      const Vector<double, Dynamic> moved = V::oplus(Vector<double, Dynamic>(estimate), Vector<double, Dynamic>(step));
      requireEstimateSize(tag(), moved.size(), dimension);
      Eigen::Map<Eigen::VectorXd>(out, dimension) = moved;
    } else {
      retractOne<V>(x, delta, out);
    }
  }
  void retractAll(const Retraction& retraction) const override {
    if constexpr (V::dimension == Dynamic) {
      const std::int64_t dimension = retraction.dimension;
      for (int i = 0; i < retraction.count; ++i) {
        retract(retraction.from + retraction.records[i], retraction.delta + i * dimension,
                retraction.to + retraction.records[i], retraction.dimension);
      }
    } else {
      detail::retractAll<V>(retraction);
    }
  }

  std::vector<std::string> tangentNames(int dimension) const override {
    std::vector<std::string> names;
    if constexpr (requires { std::begin(V::tangent); }) {
      names.assign(std::begin(V::tangent), std::end(V::tangent));
    }
    for (int i = static_cast<int>(names.size()); i < dimension; ++i)
      names.push_back("direction " + std::to_string(i + 1));
    return names;
  }

  bool gaugeGenerators(const double* values, double* generators) const override {
    if constexpr (V::dimension != Dynamic && requires(const typename V::Estimate& x) { V::gaugeGenerators(x); }) {
      const Matrix<double, V::dimension, gaugeDirections> G =
          V::gaugeGenerators(Packing<typename V::Estimate>::template load<double>(values));
      Eigen::Map<Eigen::Matrix<double, V::dimension, gaugeDirections, Eigen::RowMajor>> out(generators);
      out = G;
      return true;
    }
    return false;
  }

  void read(FieldReader& reader, Vertex& vertex) const override {
    V& typed = static_cast<V&>(vertex);
    if constexpr (ReadsItself<V>) {
      typed.read(reader);
    } else {
      typename V::Estimate estimate;
      ValueFields<typename V::Estimate>::read(reader, estimate);
      typed.setEstimate(estimate);
    }
  }
  void write(const Vertex& vertex, FieldWriter& writer) const override {
    const V& typed = static_cast<const V&>(vertex);
    if constexpr (WritesItself<V>) {
      typed.write(writer);
    } else {
      ValueFields<typename V::Estimate>::write(typed.estimate(), writer);
    }
  }
};

template <typename P>
class ParameterTypeOf final : public ParameterType {
 public:
  ParameterTypeOf(std::string tag, std::string documentation)
      : ParameterType(std::move(tag), typeName<P>(), std::move(documentation)) {}

  std::size_t objectSize() const override { return sizeof(P); }
  std::unique_ptr<ElementPool<Parameter>> makePool() const override {
    return std::make_unique<TypedPool<Parameter, P>>();
  }
  std::vector<Field> fields() const override { return fieldsOf<P, typename P::Value>(); }
  int valueCount() const override { return Packing<typename P::Value>::size; }
  const double* values(const Parameter& parameter) const override { return static_cast<const P&>(parameter).values(); }
  void read(FieldReader& reader, Parameter& parameter) const override {
    P& typed = static_cast<P&>(parameter);
    if constexpr (ReadsItself<P>) {
      typed.read(reader);
    } else {
      typename P::Value value;
      ValueFields<typename P::Value>::read(reader, value);
      typed.setValue(value);
    }
  }
  void write(const Parameter& parameter, FieldWriter& writer) const override {
    const P& typed = static_cast<const P&>(parameter);
    if constexpr (WritesItself<P>) {
      typed.write(writer);
    } else {
      ValueFields<typename P::Value>::write(typed.value(), writer);
    }
  }
};

/// Names and kinds of an edge's vertex types.
template <typename Vertices>
struct RoleNames;
template <typename... V>
struct RoleNames<std::tuple<V...>> {
  template <typename T>
  struct Role {
    static constexpr std::string_view name = typeName<T>();
    static constexpr bool any = false;
  };
  template <typename T>
  struct Role<AnyNumberOf<T>> {
    static constexpr std::string_view name = typeName<T>();
    static constexpr bool any = true;
  };
  static constexpr std::array<std::string_view, sizeof...(V)> names{Role<V>::name...};
  static constexpr bool variable = (Role<V>::any || ...);
  static constexpr bool lastAlone() {
    constexpr bool any[] = {Role<V>::any...};
    for (std::size_t i = 0; i + 1 < sizeof...(V); ++i) {
      if (any[i]) return false;
    }
    return true;
  }
};

template <typename Parameters>
struct ParameterNames;
template <typename... P>
struct ParameterNames<ParameterList<P...>> {
  static std::vector<std::string_view> names() { return {typeName<P>()...}; }
};

template <typename E>
class EdgeTypeOf final : public EdgeType {
  using Roles = RoleNames<typename E::VertexTypes>;
  static constexpr bool hasTail = requires(E & edge, const E& constant, FieldReader& reader, FieldWriter& writer) {
    E::tailFields();
    edge.readTail(reader);
    constant.writeTail(writer);
  };

 public:
  EdgeTypeOf(std::string tag, std::string documentation)
      : EdgeType(std::move(tag), typeName<E>(), std::move(documentation)) {
    static_assert(alignof(E) <= 8, "an edge may not ask for more alignment than a double");
    static_assert(E::errorDimension == Dynamic || E::errorDimension >= 1, "an error has at least one number");
    static_assert(Roles::lastAlone(), "only the last of an edge's vertices may be AnyNumberOf<V>");
  }

  std::size_t objectSize() const override { return sizeof(E); }
  std::unique_ptr<ElementPool<Edge>> makePool() const override { return std::make_unique<TypedPool<Edge, E>>(); }
  std::vector<Field> fields() const override { return fieldsOf<E, typename E::Measurement>(); }
  int arity() const override { return static_cast<int>(Roles::names.size()); }
  bool variableArity() const override { return Roles::variable; }
  std::string_view vertexTypeName(int role) const override {
    return Roles::names[std::min(static_cast<std::size_t>(role), Roles::names.size() - 1)];
  }
  std::vector<std::string_view> parameterTypeNames() const override {
    return ParameterNames<typename E::Parameters>::names();
  }
  int errorDimension() const override { return E::errorDimension; }
  int errorDimension(const Edge& edge) const override {
    return static_cast<const E&>(edge).informationStore().dimension();
  }

  std::span<const double> measurement(const Edge& edge) const override {
    if constexpr (Packable<typename E::Measurement>) {
      return {static_cast<const E&>(edge).measurementStore().values(),
              static_cast<std::size_t>(Packing<typename E::Measurement>::size)};
    } else {
      return {};
    }
  }
  std::span<const double> information(const Edge& edge) const override {
    return static_cast<const E&>(edge).informationStore().values();
  }
  void setInformation(Edge& edge, std::span<const double> triangle) const override {
    auto& store = static_cast<E&>(edge).informationStore();
    if constexpr (E::errorDimension == Dynamic) {
      int dimension = 0;
      while (dimension * (dimension + 1) / 2 < static_cast<int>(triangle.size())) ++dimension;
      store.resize(dimension);
    }
    std::copy(triangle.begin(), triangle.end(), store.values().begin());
  }
  bool hasInformationField() const override {
    if constexpr (requires {
                    { E::informationInFile } -> std::convertible_to<bool>;
                  }) {
      return E::informationInFile;
    } else {
      return true;
    }
  }

  void read(FieldReader& reader, Edge& edge) const override {
    E& typed = static_cast<E&>(edge);
    if constexpr (ReadsItself<E>) {
      typed.read(reader);
    } else {
      typename E::Measurement measurement;
      ValueFields<typename E::Measurement>::read(reader, measurement);
      typed.setMeasurement(measurement);
    }
  }
  void write(const Edge& edge, FieldWriter& writer) const override {
    const E& typed = static_cast<const E&>(edge);
    if constexpr (WritesItself<E>) {
      typed.write(writer);
    } else {
      ValueFields<typename E::Measurement>::write(typed.measurement(), writer);
    }
  }

  std::vector<Field> tailFields() const override {
    if constexpr (hasTail) {
      return E::tailFields();
    } else {
      return {};
    }
  }
  void readTail(FieldReader& reader, Edge& edge) const override {
    if constexpr (hasTail) static_cast<E&>(edge).readTail(reader);
  }
  void writeTail(const Edge& edge, FieldWriter& writer) const override {
    if constexpr (hasTail) static_cast<const E&>(edge).writeTail(writer);
  }

  std::unique_ptr<EdgeBatch> makeBatch(BatchSource& source) const override {
    if constexpr (fixedShape<E>()) {
      return std::make_unique<FixedBatch<E>>(source);
    } else {
      return std::make_unique<DynamicBatch<E>>(source);
    }
  }

  bool initialEstimate(const Edge& edge, Graph& graph, std::uint64_t known, int to) const override {
    const int count = edge.arity();
    for (int role = 0; role < count && role < 64; ++role) {
      if (role != to && !(known >> role & 1)) return false;
    }
    return propagate(static_cast<const E&>(edge), graph, to);
  }

  EdgeForm form() const override {
    if constexpr (fixedShape<E>()) {
      return EdgeFormOf<E>::describe();
    } else {
      return DynamicBatch<E>::describe();
    }
  }

 private:
  template <typename... V, typename... P>
  static bool callInitial(const E& edge, Graph& graph, int to, std::tuple<V...>*, ParameterList<P...>*) {
    if constexpr (!(requires { V::dimension; } && ...)) {
      return false;
    } else if constexpr (requires(typename V::Estimate & ... x, const typename P::Value&... p) {
                           { E::initialEstimate(to, edge.measurement(), p..., x...) } -> std::convertible_to<bool>;
                         }) {
      std::tuple<typename V::Estimate...> x;
      return [&]<int... I, int... A>(std::integer_sequence<int, I...>, std::integer_sequence<int, A...>) {
        ((std::get<I>(x) = static_cast<const V&>(vertexOf(graph, edge.vertexId(I))).estimate()), ...);
        if (!E::initialEstimate(to, edge.measurement(),
                                static_cast<const P&>(parameterOf(graph, edge.parameterIds()[A])).value()...,
                                std::get<I>(x)...)) {
          return false;
        }
        ((I == to ? static_cast<V&>(vertexOf(graph, edge.vertexId(I))).setEstimate(std::get<I>(x)) : void()), ...);
        return true;
      }
      (std::make_integer_sequence<int, sizeof...(V)>(), std::make_integer_sequence<int, sizeof...(P)>());
    } else {
      return false;
    }
  }
  static bool propagate(const E& edge, Graph& graph, int to) {
    return callInitial(edge, graph, to, static_cast<typename E::VertexTypes*>(nullptr),
                       static_cast<typename E::Parameters*>(nullptr));
  }
};

}  // namespace quiver::detail

namespace quiver {

template <typename V>
const VertexType& Registry::addVertex(std::string tag, std::string documentation) {
  return add(
      std::unique_ptr<VertexType>(std::make_unique<detail::VertexTypeOf<V>>(std::move(tag), std::move(documentation))));
}
template <typename E>
const EdgeType& Registry::addEdge(std::string tag, std::string documentation) {
  return add(
      std::unique_ptr<EdgeType>(std::make_unique<detail::EdgeTypeOf<E>>(std::move(tag), std::move(documentation))));
}
template <typename P>
const ParameterType& Registry::addParameter(std::string tag, std::string documentation) {
  return add(std::unique_ptr<ParameterType>(
      std::make_unique<detail::ParameterTypeOf<P>>(std::move(tag), std::move(documentation))));
}

}  // namespace quiver
