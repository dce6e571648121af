#pragma once

#include <array>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace quiver::bench {

/// A pose graph as a program without quiver would hold it: heap objects, found by id.
struct StreamVertex {
  std::vector<double> values;
};
struct StreamEdge {
  int from = 0;
  int to = 0;
  std::vector<double> measurement;
  /// Upper triangle, row by row.
  std::vector<double> information;
};
struct StreamGraph {
  int dimension = 0;  // 2 or 3
  std::map<int, std::unique_ptr<StreamVertex>> vertices;
  std::vector<std::unique_ptr<StreamEdge>> edges;
};

/// Reads planar and spatial pose graphs line by line with a string stream, the usual way.
inline StreamGraph readWithStreams(const std::string& file) {
  StreamGraph graph;
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream tokens(line);
    std::string tag;
    tokens >> tag;
    const bool space = tag.find("SE3") != std::string::npos;
    const int values = space ? 7 : 3;
    if (tag.starts_with("VERTEX")) {
      int id;
      tokens >> id;
      auto vertex = std::make_unique<StreamVertex>();
      vertex->values.resize(static_cast<std::size_t>(values));
      for (double& value : vertex->values) tokens >> value;
      graph.vertices.emplace(id, std::move(vertex));
      graph.dimension = space ? 3 : 2;
    } else if (tag.starts_with("EDGE")) {
      auto edge = std::make_unique<StreamEdge>();
      tokens >> edge->from >> edge->to;
      edge->measurement.resize(static_cast<std::size_t>(values));
      edge->information.resize(space ? 21 : 6);
      for (double& value : edge->measurement) tokens >> value;
      for (double& value : edge->information) tokens >> value;
      graph.edges.push_back(std::move(edge));
    }
  }
  return graph;
}

}  // namespace quiver::bench
