#include <quiver/core/registry/conformance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/SVD>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/problem/retraction.h>
#include <quiver/core/registry/field_tokens.h>
#include <quiver/core/registry/world_invariance.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

using detail::uniform;

class Conformance {
 public:
  Conformance(std::shared_ptr<const Registry> registry, const ConformanceOptions& options)
      : registry_(std::move(registry)), options_(options), random_(options.seed) {}

  ConformanceReport run() {
    for (const auto& type : registry_->vertexTypes()) {
      if (wanted(*type)) guarded(*type, [&] { checkVertexType(*type); });
    }
    for (const auto& type : registry_->parameterTypes()) {
      if (wanted(*type)) guarded(*type, [&] { checkParameterType(*type); });
    }
    for (const auto& type : registry_->edgeTypes()) {
      if (wanted(*type)) guarded(*type, [&] { checkEdgeType(*type); });
    }
    return std::move(report_);
  }

 private:
  /// How the estimates of a made-up edge are chosen.
  enum class Draw { random, nearSolution, nearHalfTurn, count };
  /// Numbers of an estimate whose size the type leaves open.
  static constexpr int runTimeSize = 3;

  bool wanted(const ElementType& type) {
    const bool all = options_.tags.empty();
    return all || std::find(options_.tags.begin(), options_.tags.end(), type.tag()) != options_.tags.end();
  }

  template <typename Check>
  void guarded(const ElementType& type, Check check) {
    ++report_.types;
    try {
      check();
    } catch (const std::exception& error) {
      report_.findings.push_back({type.tag(), "fields", error.what()});
    } catch (...) {
      report_.findings.push_back({type.tag(), "fields", "it throws what is no std::exception"});
    }
  }

  void expect(bool holds, const ElementType& type, const char* check, const std::string& message) {
    ++report_.checks;
    if (holds) return;
    for (const ConformanceFinding& finding : report_.findings) {
      if (finding.tag == type.tag() && finding.check == check) return;  // one of a kind is enough
    }
    report_.findings.push_back({type.tag(), check, message});
  }

  /// Reads a made-up line; some types refuse some numbers, so several are tried.
  template <typename Type, typename Element>
  void readRandom(const Type& type, Element& element, std::int64_t count) {
    constexpr int trials = 20;
    for (int trial = 1;; ++trial) {
      detail::RandomReader reader(random_, type.fields(), count);
      try {
        type.read(reader, element);
        if constexpr (std::is_same_v<Type, EdgeType>) {
          detail::RandomReader tail(random_, type.tailFields(), count);
          type.readTail(tail, element);
        }
        return;
      } catch (const Error&) {
        if (trial == trials) throw;
      }
    }
  }

  template <typename Type, typename Element>
  void checkRoundTrip(const Type& type, const Element& element, Element& other, bool countFields) {
    detail::TokenWriter first, second;
    writeAll(type, element, first);
    detail::TokenReader reader(first.tokens());
    type.read(reader, other);
    if constexpr (std::is_same_v<Type, EdgeType>) type.readTail(reader, other);
    expect(reader.atEnd(), type, "round trip", "reading leaves numbers that were written");
    writeAll(type, other, second);
    const auto same = [](const auto& a, const auto& b) { return a.same(b); };
    expect(
        std::equal(first.tokens().begin(), first.tokens().end(), second.tokens().begin(), second.tokens().end(), same),
        type, "round trip", "what was written and read is written with other bits");
    const std::size_t listed = type.fields().size() + type.tailFields().size();
    expect(!countFields || first.tokens().size() == listed, type, "fields",
           fmt::format("{} numbers are written, fields() lists {}", first.tokens().size(), listed));
  }

  template <typename Type, typename Element>
  static void writeAll(const Type& type, const Element& element, FieldWriter& writer) {
    type.write(element, writer);
    if constexpr (std::is_same_v<Type, EdgeType>) type.writeTail(element, writer);
  }

  Vertex& makeVertex(Graph& graph, const VertexType& type, std::int64_t id) {
    Vertex& vertex = graph.addVertex(type, id);
    readRandom(type, vertex, type.dimension() == Dynamic ? runTimeSize : 1);
    vertex.setHasEstimate(true);
    move(type, vertex, [&](int) { return uniform(random_, -0.7, 0.7); });
    return vertex;
  }

  template <typename Step>
  void move(const VertexType& type, Vertex& vertex, Step step) {
    std::vector<double> delta(static_cast<std::size_t>(type.dimension(vertex)));
    for (std::size_t i = 0; i < delta.size(); ++i) delta[i] = step(static_cast<int>(i));
    std::vector<double> moved(static_cast<std::size_t>(type.valueCount(vertex)));
    type.retract(type.values(vertex), delta.data(), moved.data(), static_cast<int>(delta.size()));
    type.setValues(vertex, moved.data());
  }

  void checkVertexType(const VertexType& type) {
    Graph graph(registry_);
    for (int draw = 0; draw < options_.draws; ++draw) {
      Vertex& vertex = makeVertex(graph, type, 3 * draw);
      Vertex& other = graph.addVertex(type, 3 * draw + 1);
      Vertex& third = graph.addVertex(type, 3 * draw + 2);
      checkRoundTrip(type, vertex, other, type.dimension() != Dynamic);
      checkRoundTrip(type, other, third, type.dimension() != Dynamic);
      checkEstimates(type, vertex, other, third);
      checkStep(type, vertex);
    }
  }

  /// What was read once reads again to the same bits. The first time, a type that stores other numbers than it writes
  /// (angles for a quaternion) may round, and the sign of numbers that stand for the same may change.
  void checkEstimates(const VertexType& type, const Vertex& made, const Vertex& read, const Vertex& again) {
    constexpr double rounding = 1e-12;
    const int count = type.valueCount(made);
    bool same = type.valueCount(read) == count && type.valueCount(again) == count;
    for (int i = 0; same && i < count; ++i) {
      const double x = type.values(made)[i], y = type.values(read)[i];
      same = std::abs(std::abs(x) - std::abs(y)) <= rounding * std::max(1.0, std::abs(x)) && y == type.values(again)[i];
    }
    expect(same, type, "round trip", "the estimate changes");
  }

  void checkStep(const VertexType& type, const Vertex& vertex) {
    const int dimension = type.dimension(vertex);
    const auto count = static_cast<std::size_t>(type.valueCount(vertex));
    const std::vector<double> x(type.values(vertex), type.values(vertex) + count);
    std::vector<double> delta(static_cast<std::size_t>(dimension), 0.0), out(count);
    const std::size_t names = type.tangentNames(dimension).size();
    expect(names == delta.size(), type, "oplus", fmt::format("{} names for {} directions", names, delta.size()));
    type.retract(x.data(), delta.data(), out.data(), dimension);
    double size = 1.0, change = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      size = std::max(size, std::abs(x[i]));
      change = std::max(change, std::abs(out[i] - x[i]));
    }
    expect(change <= 1e-14 * size, type, "oplus", fmt::format("x oplus 0 differs from x by {:.3g}", change));
    for (double& step : delta) step = uniform(random_, -0.5, 0.5);
    type.retract(x.data(), delta.data(), out.data(), dimension);
    std::vector<double> inPlace = x;
    type.retract(inPlace.data(), delta.data(), inPlace.data(), dimension);
    expect(inPlace == out, type, "oplus", "x oplus delta differs when written over x");
    checkTogether(type, x, dimension);
    checkDirections(type, x, dimension);
  }

  /// Vertices moved together end where each does alone, but for rounding.
  void checkTogether(const VertexType& type, const std::vector<double>& x, int dimension) {
    constexpr int count = 11;
    constexpr double rounding = 1e-13;
    const std::size_t stride = (x.size() + 7) / 8 * 8;
    std::vector<double> from(count * stride + 8, 0.0), to = from, alone(x.size());
    std::vector<double> delta(static_cast<std::size_t>(count * dimension));
    for (double& step : delta) step = uniform(random_, -0.5, 0.5);
    std::vector<std::int64_t> records;
    for (std::size_t i = 0; i < count; ++i) {
      records.push_back(static_cast<std::int64_t>(i * stride));
      std::copy(x.begin(), x.end(), from.begin() + records.back());
    }
    type.retractAll({records.data(), count, dimension, from.data(), delta.data(), to.data()});
    double difference = 0.0;
    for (int i = 0; i < count; ++i) {
      type.retract(x.data(), delta.data() + i * dimension, alone.data(), dimension);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double value = to[static_cast<std::size_t>(records[static_cast<std::size_t>(i)]) + k];
        const double own = std::abs(value - alone[k]) / std::max(1.0, std::abs(alone[k]));
        if (!(own <= difference)) difference = std::isnan(own) ? std::numeric_limits<double>::infinity() : own;
      }
    }
    expect(difference <= rounding, type, "oplus", fmt::format("many at once differ from one by {:.3g}", difference));
  }

  /// The derivative of x ⊞ δ at 0 has independent columns, whatever their lengths.
  void checkDirections(const VertexType& type, const std::vector<double>& x, int dimension) {
    constexpr double step = 1e-6, least = 1e-4;
    Eigen::MatrixXd J(static_cast<Eigen::Index>(x.size()), dimension);
    Eigen::VectorXd forward(J.rows()), backward(J.rows()), delta = Eigen::VectorXd::Zero(dimension);
    for (int c = 0; c < dimension; ++c) {
      delta[c] = step;
      type.retract(x.data(), delta.data(), forward.data(), dimension);
      delta[c] = -step;
      type.retract(x.data(), delta.data(), backward.data(), dimension);
      delta[c] = 0.0;
      J.col(c) = (forward - backward) / (2.0 * step);
      J.col(c) /= std::max(J.col(c).norm(), std::numeric_limits<double>::min());
    }
    const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
    expect(J.allFinite() && singular[dimension - 1] > least * singular[0], type, "oplus",
           fmt::format("directions of the tangent depend on each other: singular values {:.3g} to {:.3g}", singular[0],
                       singular[dimension - 1]));
  }

  void checkParameterType(const ParameterType& type) {
    Graph graph(registry_);
    for (int draw = 0; draw < options_.draws; ++draw) {
      Parameter& parameter = graph.addParameter(type, 2 * draw);
      readRandom(type, parameter, 1);
      checkRoundTrip(type, parameter, graph.addParameter(type, 2 * draw + 1), true);
    }
  }

  void checkEdgeType(const EdgeType& type) {
    Graph graph(registry_);
    std::int64_t nextVertex = 0, nextParameter = 0;
    for (int draw = 0; draw < options_.draws; ++draw) {
      const int extra = type.variableArity() ? draw % 3 : 0;
      std::vector<std::int64_t> vertices, parameters;
      for (int role = 0; role < type.arity() + extra; ++role) {
        // The registry refuses edges whose vertex and parameter types it does not know.
        const VertexType& vertex = *registry_->findVertexTypeByName(type.vertexTypeName(role));
        vertices.push_back(makeVertex(graph, vertex, nextVertex++).id());
      }
      for (const std::string_view name : type.parameterTypeNames()) {
        const ParameterType& parameter = *registry_->findParameterTypeByName(name);
        readRandom(parameter, graph.addParameter(parameter, nextParameter), 1);
        parameters.push_back(nextParameter++);
      }
      Edge& edge = graph.addEdge(type, vertices, parameters);
      readRandom(type, edge, std::max<std::int64_t>(1, static_cast<std::int64_t>(vertices.size()) - 1));
      Edge& other = graph.addEdge(type, vertices, parameters);
      checkRoundTrip(type, edge, other, !type.variableArity() && type.errorDimension() != Dynamic);
      graph.removeEdge(other);
      settleDimension(graph, type, edge);
      randomInformation(type, edge);
      placeVertices(graph, type, edge, static_cast<Draw>(draw % static_cast<int>(Draw::count)));
    }
    checkEdgeNumbers(graph, type);
  }

  /// Gives an error of run-time dimension an information matrix of the size it asks for, found by trying.
  static void settleDimension(Graph& graph, const EdgeType& type, Edge& edge) {
    constexpr int most = 64;
    for (int n = 1; type.errorDimension() == Dynamic && n <= most; ++n) {
      std::vector<double> identity;
      for (int r = 0; r < n; ++r) {
        identity.push_back(1.0);
        identity.insert(identity.end(), static_cast<std::size_t>(n - 1 - r), 0.0);
      }
      type.setInformation(edge, identity);
      try {
        ProblemScope scope;
        scope.level = -1;
        Problem problem(graph, scope);
        (void)problem.evaluate(problem.state());
        return;
      } catch (const GraphError&) {
        if (n == most) throw;
      }
    }
  }

  /// L Lᵀ with L lower triangular of diagonal about 1.
  void randomInformation(const EdgeType& type, Edge& edge) {
    const int n = type.errorDimension(edge);
    Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c <= r; ++c) L(r, c) = r == c ? uniform(random_, 0.5, 1.5) : uniform(random_, -0.3, 0.3);
    }
    const Eigen::MatrixXd information = L * L.transpose();
    std::vector<double> triangle;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) triangle.push_back(information(r, c));
    }
    type.setInformation(edge, triangle);
  }

  void placeVertices(Graph& graph, const EdgeType& type, const Edge& edge, Draw draw) {
    if (draw == Draw::random) return;
    const int count = edge.arity();
    int target = count - 1;
    while (target >= 0 && !type.initialEstimate(edge, graph, ~(std::uint64_t{1} << target), target)) --target;
    if (target < 0) return;
    for (int k = 0; k < count; ++k) {
      const int role = (target + k) % count;
      Vertex& vertex = *graph.findVertex(edge.vertexId(role));
      const VertexType& vertexType = graph.typeOf(vertex);
      if (draw == Draw::nearSolution) {
        move(vertexType, vertex, [&](int) { return uniform(random_, -0.05, 0.05); });
      } else if (turn(vertexType, vertex)) {
        return;
      }
    }
  }

  /// Turns a vertex by half a turn less 3e-5 to 1e-4 about any axis; false if its tangent has no angles.
  bool turn(const VertexType& type, Vertex& vertex) {
    constexpr double halfTurn = 3.14159265358979323846;
    std::vector<int> angles;
    const std::vector<std::string> names = type.tangentNames(type.dimension(vertex));
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].ends_with("[rad]")) angles.push_back(static_cast<int>(i));
    }
    if (angles.empty()) return false;
    angles.resize(angles.size() >= 3 ? 3 : 1);
    std::vector<double> axis(angles.size());
    double square = 0.0;
    for (double& part : axis) {
      part = uniform(random_, -1.0, 1.0);
      square += part * part;
    }
    const double scale = (halfTurn - uniform(random_, 3e-5, 1e-4)) / std::sqrt(square);
    move(type, vertex, [&](int direction) {
      const auto found = std::find(angles.begin(), angles.end(), direction);
      return found == angles.end() ? 0.0 : scale * axis[static_cast<std::size_t>(found - angles.begin())];
    });
    return true;
  }

  void checkEdgeNumbers(Graph& graph, const EdgeType& type) {
    const auto& approximate = options_.approximateJacobians;
    if (std::find(approximate.begin(), approximate.end(), type.tag()) == approximate.end()) {
      JacobianCheckOptions options;
      options.edgesPerType = 0;
      const JacobianReport report = checkJacobians(graph, options);
      // The line on the type, without its tag, which findings have.
      std::string line = report.describe();
      line = line.substr(0, line.find('\n')).substr(std::min(line.size(), type.tag().size() + 2));
      expect(report.worstDeviation() <= options_.jacobianTolerance, type, "jacobians", line);
    }
    ProblemScope scope;
    scope.level = -1;
    const Problem problem(graph, scope);
    WorldInvariance invariance{type.tag(), 0};
    for (int direction = 0; direction < gaugeDirections; ++direction) {
      if (staysWithWorld(problem, direction)) invariance.directions |= std::uint32_t{1} << direction;
    }
    report_.invariances.push_back(invariance);
  }

  std::shared_ptr<const Registry> registry_;
  const ConformanceOptions& options_;
  std::mt19937_64 random_;
  ConformanceReport report_;
};

}  // namespace

ConformanceReport checkConformance(std::shared_ptr<const Registry> registry, const ConformanceOptions& options) {
  ConformanceReport report = Conformance(registry, options).run();
  if (options.tags.empty()) {
    std::vector<std::string> names;
    for (const RobustKernelType* kernel : registry->robustKernels()) names.emplace_back(kernel->name);
    checkKernels(*registry, names, report);
  }
  return report;
}

std::string ConformanceReport::describe() const {
  std::string text;
  for (const ConformanceFinding& finding : findings) {
    text += fmt::format("{}: {}: {}\n", finding.tag, finding.check, finding.message);
  }
  text += fmt::format("{} types, {} checks, {} findings\n", types, checks, findings.size());
  return text;
}

}  // namespace quiver
