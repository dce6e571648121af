#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include <quiver/core/io/g2o/g2o_element_reader.h>
#include <quiver/core/io/toro/bearing_range.h>

namespace quiver::detail {
namespace {

/// I11 I12 I22 I33 I13 I23 to the rows of the upper triangle.
void reorderToro(std::vector<double>& triangle) {
  if (triangle.size() != 6) return;
  triangle = {triangle[0], triangle[1], triangle[4], triangle[2], triangle[5], triangle[3]};
}

/// n with n (n + 1) / 2 = entries.
int triangleDimension(std::size_t entries) {
  int n = 0;
  for (std::size_t sum = 0; sum < entries; sum += static_cast<std::size_t>(++n)) continue;
  return n;
}

}  // namespace

void G2oElementReader::read(const G2oLine& line, void* element) {
  const Registry& registry = tags_.registry();
  const auto index = static_cast<std::size_t>(line.entry->type);
  G2oFieldReader reader(source_, tags_.elementType(*line.entry), line.begin, line.fields);
  try {
    if (line.kind == LineKind::parameter) {
      registry.parameterTypes()[index]->read(reader, *static_cast<Parameter*>(element));
    } else if (line.kind == LineKind::vertex) {
      Vertex& vertex = *static_cast<Vertex*>(element);
      registry.vertexTypes()[index]->read(reader, vertex);
      vertex.setHasEstimate(true);
    } else if (line.kind == LineKind::edge) {
      readEdge(line, *static_cast<Edge*>(element), reader);
    }
  } catch (const ParseError&) {
    throw;
  } catch (const Error& error) {
    reader.fail(error.what());
  } catch (const std::bad_alloc&) {
    reader.fail("this needs more memory than there is");
  } catch (const std::length_error&) {
    reader.fail("this needs more memory than there is");
  }
  reader.expectEnd();
}

void G2oElementReader::readEdge(const G2oLine& line, Edge& edge, G2oFieldReader& reader) {
  const EdgeType& type = *tags_.registry().edgeTypes()[static_cast<std::size_t>(line.entry->type)];
  if (line.entry->dialect == LineDialect::bearingRange) return readBearingRange(type, reader, edge);
  if (type.errorDimension() == Dynamic) refuseHopeless(line);
  type.read(reader, edge);
  if (line.entry->informationInLine) {
    readInformation(type, line, edge, reader);
  } else {
    const std::span<const double> made = type.information(edge);
    triangle_.assign(made.begin(), made.end());
    triangleEntry_ = nullptr;
    setInformation(type, edge, line.fields);
  }
  type.readTail(reader, edge);
}

void G2oElementReader::readInformation(const EdgeType& type, const G2oLine& line, Edge& edge, G2oFieldReader& reader) {
  const int dimension = type.errorDimension();
  if (triangleEntry_ == line.entry && reader.skipInformation(dimension, triangleText_))
    return type.setInformation(edge, triangle_);
  triangleEntry_ = nullptr;
  reader.information(dimension != Dynamic ? dimension : type.errorDimension(edge), triangle_);
  if (line.entry->dialect == LineDialect::toro) reorderToro(triangle_);
  if (!setInformation(type, edge, reader.informationPlace()) || dimension == Dynamic) return;
  triangleEntry_ = line.entry;
  triangleText_ = reader.informationText();
}

bool G2oElementReader::setInformation(const EdgeType& type, Edge& edge, const char* place) {
  const int dimension = triangleDimension(triangle_.size());
  const bool good = check_.accepts(triangle_, dimension);
  if (!good && options_.information == InformationPolicy::clamp) {
    clampInformation(triangle_, dimension);
    ++faults_.clamped;
  } else if (!good && faults_.refused++ == 0) {
    faults_.firstRefused = place;
    faults_.firstRange = eigenvalueRange(triangle_, dimension);
  }
  type.setInformation(edge, triangle_);
  return good;
}

/// An edge over very many vertices asks for an information matrix of that many rows at least: a line too short for it
/// is refused before its type reserves memory for the square of a number that anybody can write.
void G2oElementReader::refuseHopeless(const G2oLine& line) const {
  constexpr std::size_t many = 1000;
  const std::size_t vertices = line.idCount;
  if (vertices <= many) return;
  TextScanner rest(std::string_view(line.fields, static_cast<std::size_t>(source_.end() - line.fields)));
  if (rest.nextLine().size() / vertices < vertices) {
    throw source_.endsEarly(line.fields, fmt::format("the information matrix for {} vertices is missing", vertices));
  }
}

}  // namespace quiver::detail
