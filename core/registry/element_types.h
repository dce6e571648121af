#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/graph/edge.h>
#include <quiver/core/graph/element_pool.h>
#include <quiver/core/registry/fields.h>
#include <quiver/core/registry/place.h>

namespace quiver {

class EdgeBatch;
class Graph;
struct BatchSource;
struct Retraction;

/// What every descriptor of a registry tells: its tag in files, its C++ type, and documentation for `quiver list`.
class ElementType {
 public:
  virtual ~ElementType() = default;
  const std::string& tag() const { return tag_; }
  /// `quiver::typeName` of the C++ class.
  std::string_view cppName() const { return cppName_; }
  /// sizeof the C++ class: with its name, what tells classes apart.
  virtual std::size_t objectSize() const = 0;
  /// Index in the registry that holds this descriptor.
  int index() const { return index_; }
  /// One paragraph: what it is, its frame, the formula and its source.
  const std::string& documentation() const { return documentation_; }
  /// The numbers of a file's line after the ids, without the information matrix.
  virtual std::vector<Field> fields() const = 0;
  /// Numbers that stand behind the information matrix, where g2o's format has no place for them.
  virtual std::vector<Field> tailFields() const { return {}; }

 protected:
  ElementType(std::string tag, std::string_view cppName, std::string documentation)
      : tag_(std::move(tag)), cppName_(cppName), documentation_(std::move(documentation)) {}

 private:
  friend class Registry;
  std::string tag_;
  std::string_view cppName_;
  std::string documentation_;
  int index_ = -1;
};

/// Whether a vertex's estimate is a pose, and of what: then its values are those of Packing<SE2<double>> or
/// Packing<SE3<double>>.
enum class PoseKind { none, plane, space };

/// Descriptor of a vertex type. Its functions act on vertices of that type only.
class VertexType : public ElementType {
 public:
  virtual std::unique_ptr<ElementPool<Vertex>> makePool() const = 0;
  /// Dimension of the tangent; Dynamic if it differs from vertex to vertex.
  virtual int dimension() const = 0;
  virtual int dimension(const Vertex& vertex) const = 0;
  virtual PoseKind poseKind() const = 0;
  /// Where vertices of the type are in the world: what the type's optional `static … place(const Estimate&)` returns, a
  /// pose (SE2 or SE3, body to world) or a point (Vector of 2 or 3) in metres; an estimate that is an SE2 or SE3 if it
  /// has none.
  virtual PlaceKind placeKind() const = 0;
  /// As a pose in space; z = 0 in the plane, no rotation for a point. Requires a kind that is not none.
  virtual SE3<double> place(const double* values) const = 0;
  /// Number of doubles that hold the estimate.
  virtual int valueCount(const Vertex& vertex) const = 0;
  virtual const double* values(const Vertex& vertex) const = 0;
  /// Overwrites the estimate and marks it as present.
  virtual void setValues(Vertex& vertex, const double* values) const = 0;
  /// Sets the estimate to the origin, a group's identity or a vector of zeros, and marks it as present.
  virtual void setToOrigin(Vertex& vertex) const = 0;

  /// out = x ⊞ delta on value arrays; `dimension` is the tangent's. out may be x.
  virtual void retract(const double* x, const double* delta, double* out, int dimension) const = 0;

  /// The same for many vertices of one dimension; records must not overlap. Eight at a time where the type sets
  /// `lanes`.
  virtual void retractAll(const Retraction& retraction) const = 0;

  /// Names of the tangent's directions, with units: "x [m]"; "direction i" where the type gives none.
  virtual std::vector<std::string> tangentNames(int dimension) const = 0;

  /// Directions in which moving the whole world leaves errors unchanged, as tangent vectors of this vertex: a row-major
  /// dimension × gaugeDirections array, one column per generator in the order of `GaugeDirection`. Returns false if the
  /// type supplies none.
  virtual bool gaugeGenerators(const double* values, double* generators) const = 0;

  virtual void read(FieldReader& reader, Vertex& vertex) const = 0;
  virtual void write(const Vertex& vertex, FieldWriter& writer) const = 0;

 protected:
  using ElementType::ElementType;
};

/// The ways a whole world may move unnoticed: translations, rotations about the world's axes, scale about its origin.
enum GaugeDirection { gaugeX, gaugeY, gaugeZ, gaugeRoll, gaugePitch, gaugeYaw, gaugeScale, gaugeDirections };

/// Descriptor of a parameter type.
class ParameterType : public ElementType {
 public:
  virtual std::unique_ptr<ElementPool<Parameter>> makePool() const = 0;
  virtual int valueCount() const = 0;
  virtual const double* values(const Parameter& parameter) const = 0;
  virtual void read(FieldReader& reader, Parameter& parameter) const = 0;
  virtual void write(const Parameter& parameter, FieldWriter& writer) const = 0;

 protected:
  using ElementType::ElementType;
};

/// How a type's Jacobians and loops are made, for `describe()`.
struct EdgeForm {
  Jacobians jacobians = Jacobians::numeric;
  bool lanes = false;
  /// Why this form and not a better one.
  std::string reason;
};

/// Descriptor of an edge type. Its functions act on edges of that type only.
class EdgeType : public ElementType {
 public:
  virtual std::unique_ptr<ElementPool<Edge>> makePool() const = 0;
  /// Number of vertices; for a variable number the least one.
  virtual int arity() const = 0;
  virtual bool variableArity() const = 0;
  /// C++ name of the vertex type of a role; the last one stands for all further ones of a variable-arity edge.
  virtual std::string_view vertexTypeName(int role) const = 0;
  virtual std::vector<std::string_view> parameterTypeNames() const = 0;
  /// Dimension of the error; Dynamic if it differs from edge to edge.
  virtual int errorDimension() const = 0;
  virtual int errorDimension(const Edge& edge) const = 0;

  /// The numbers of the measurement; none if it is not of a packable type.
  virtual std::span<const double> measurement(const Edge& edge) const = 0;
  /// Upper triangle of the information matrix, row by row.
  virtual std::span<const double> information(const Edge& edge) const = 0;
  /// Sets it unchecked; the number of entries decides a run-time dimension.
  virtual void setInformation(Edge& edge, std::span<const double> triangle) const = 0;
  /// Whether a file's line carries the information matrix after the fields.
  virtual bool hasInformationField() const = 0;

  virtual void read(FieldReader& reader, Edge& edge) const = 0;
  virtual void write(const Edge& edge, FieldWriter& writer) const = 0;
  /// The same for tailFields(); what may be left out is the type's business.
  virtual void readTail(FieldReader&, Edge&) const {}
  virtual void writeTail(const Edge&, FieldWriter&) const {}

  /// Compiles edges of this type.
  virtual std::unique_ptr<EdgeBatch> makeBatch(BatchSource& source) const = 0;

  /// Propagation: sets the estimate of the vertex at role `to` from the others', which have one. `known` has a bit for
  /// each role whose vertex has an estimate. Returns false if this edge cannot tell it.
  virtual bool initialEstimate(const Edge& edge, Graph& graph, std::uint64_t known, int to) const = 0;

  virtual EdgeForm form() const = 0;

 protected:
  using ElementType::ElementType;
};

}  // namespace quiver
