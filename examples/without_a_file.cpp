// A graph made in memory: a robot of unknown place hears three beacons of known place.
#include <quiver/quiver.h>
#include <iostream>

#include "plaza.h"
using namespace quiver;
using plaza::EdgeRange;
using plaza::VertexBeacon;

int main() {
  Graph graph(plaza::makeRegistry());
  auto& pose = graph.addVertex<VertexSE2>(0, SE2<double>(1.0, 2.0, 0.5));
  pose.setFixedDirections(0b100);  // ranges do not tell the heading: it is held
  const Matrix<double, 1, 1> information(100.0);
  graph.addVertex<VertexBeacon>(100, Vector<double, 2>(0.0, 0.0)).setFixed(true);
  graph.addVertex<VertexBeacon>(101, Vector<double, 2>(10.0, 0.0)).setFixed(true);
  graph.addVertex<VertexBeacon>(102, Vector<double, 2>(0.0, 10.0)).setFixed(true);
  graph.addEdge<EdgeRange>({0, 100}, 5.0, information);
  graph.addEdge<EdgeRange>({0, 101}, 8.062257748298549, information);
  auto& doubtful = graph.addEdge<EdgeRange>({0, 102}, 6.708203932499369, information);
  doubtful.setRobustKernel(RobustKernelHuber(1.0));

  const Summary summary = optimize(graph);
  std::cout << summary << "the robot stands at " << pose.estimate().translation().transpose() << "\n";
  return summary.converged() ? 0 : 1;
}
