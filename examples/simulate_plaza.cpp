// Writes plaza.g2o: a simulated robot with odometry and ranges to five beacons, always the same.
#include "plaza.h"

#include <iostream>

int main() {
  const auto simulated = plaza::Simulation(1).run();
  quiver::writeGraph("plaza.g2o", simulated.graph);
  std::cout << "plaza.g2o: " << simulated.graph.vertexCount() << " vertices, " << simulated.graph.edgeCount()
            << " edges\n";
  for (const auto& [id, place] : simulated.beacons)
    std::cout << "beacon " << id << " stands at " << place[0] << " " << place[1] << "\n";
}
