// Bundle adjustment: ladybug-49 against Ceres's Schur solvers, the pose of one camera against objects on the heap, the
// price of intrinsics that all edges share, and a simulated problem of many observations.
//   quiver_bench_bundle [--json FILE] [--rounds N] [FILE.txt...]
//     QUIVER_BENCH_POINTS=N   points of the simulated problem, four observations each (250000)
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include <quiver/apps/support/freed_memory.h>
#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/quiver.h>
#include <quiver/types_sba/expmap/edge_se3_project_xyz.h>
#include <quiver/types_sba/models/edge_project.h>

#include "bundle_motion.h"
#include "bundle_published.h"
#include "peers/measure.h"

using namespace quiver;

namespace {

constexpr int threads = 2;

// ---- the pose of one camera ----

constexpr double huber = 2.0;

struct MotionCase {
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  Eigen::Vector4d intrinsics{500.0, 500.0, 320.0, 240.0};
  std::vector<bench::KnownPoint> points;
};

/// 300 points before a camera at the origin, pixels with a deviation of about half a pixel, a tenth of them wrong.
MotionCase makeMotion() {
  MotionCase motion;
  std::mt19937_64 random(1);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 300; ++i) {
    const double z = uniform(3.0, 12.0);
    const Eigen::Vector3d p(z * uniform(-0.6, 0.6), z * uniform(-0.4, 0.4), z);
    Eigen::Vector2d pixel(500.0 * p[0] / z + 320.0 + uniform(-0.9, 0.9), 500.0 * p[1] / z + 240.0 + uniform(-0.9, 0.9));
    if (i % 10 == 0) pixel += Eigen::Vector2d(uniform(-100.0, 100.0), uniform(-100.0, 100.0));
    motion.points.push_back({p, pixel});
  }
  motion.start.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  motion.start.translation() = Eigen::Vector3d(0.1, -0.08, 0.15);
  return motion;
}

/// Makes exactly so many trial steps: stopping rules are off. Returns the cost.
double moveCamera(const std::shared_ptr<const Registry>& registry, const MotionCase& motion, int iterations) {
  Graph graph(registry);
  const Eigen::Vector3d t = motion.start.translation();
  graph.addVertex<VertexSE3Expmap>(0, SE3<double>(SO3<double>::fromMatrix(motion.start.linear()), t));
  const Matrix<double, 2, 2> information = Matrix<double, 2, 2>::Identity();
  const RobustKernel kernel = RobustKernelHuber(huber);
  for (const bench::KnownPoint& known : motion.points) {
    Vector<double, 9> measurement;
    measurement.head<2>() = known.pixel;
    measurement.segment<4>(2) = motion.intrinsics;
    measurement.tail<3>() = known.point;
    graph.addEdge<EdgeSE3ProjectXYZOnlyPose>({0}, measurement, information).setRobustKernel(kernel);
  }
  Options options = bench::untilIterations(iterations);
  options.threads = 1;
  const Summary summary = optimize(graph, options);
  if (static_cast<int>(summary.iterations.size()) != iterations)
    throw LogicError(fmt::format("{} trial steps instead of {}", summary.iterations.size(), iterations));
  return summary.finalCost;
}

void compareMotion(int rounds, bench::JsonRows& json) {
  constexpr int iterations = 10, repetitions = 50;
  const auto registry = builtinRegistry();
  const MotionCase motion = makeMotion();
  double ours = 0.0, theirs = 0.0;
  const auto repeated = [&](auto&& work) {
    return bench::secondsOf([&] {
             for (int i = 0; i < repetitions; ++i) work();
           }) /
           repetitions;
  };
  const bench::Pair pair = bench::comparePairs(
      rounds, [&] { return repeated([&] { ours = moveCamera(registry, motion, iterations); }); },
      [&] {
        return repeated([&] {
          theirs = bench::moveCameraOnHeap(motion.start, motion.points, motion.intrinsics, huber, iterations).cost;
        });
      });
  const bool same = std::abs(ours - theirs) <= 1e-6 * theirs;
  const double built = repeated([&] { moveCamera(registry, motion, 0); });
  fmt::print(
      "one pose, 300 observations, 10 iterations from scratch: {:.1f} us ({:.1f} without the iterations), heap "
      "objects {:.1f} us, {:.1f}x{}\n",
      1e6 * pair.ours, 1e6 * built, 1e6 * pair.theirs, pair.ratio, same ? "" : "  RESULTS DIFFER");
  json.begin("motion only");
  json.add("seconds", pair.ours);
  json.add("seconds_without_iterations", built);
  json.add("heap_seconds", pair.theirs);
  json.add("ratio", pair.ratio);
  json.add("same_result", same ? 1.0 : 0.0);
}

// ---- intrinsics that all edges share ----

enum class Sharing { parameter, fixedVertex, freeVertex };

/// 60 poses round a field of 4000 points, each seen by up to 8 of them.
Graph makeShared(const std::shared_ptr<const Registry>& registry, Sharing sharing) {
  constexpr int poses = 60, points = 4000;
  const Vector<double, 4> intrinsics(500.0, 500.0, 320.0, 240.0);
  Graph graph(registry);
  std::mt19937_64 random(2);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  if (sharing == Sharing::parameter) {
    graph.addParameter<ParameterPinhole>(0, intrinsics);
  } else {
    graph.addVertex<VertexPinhole>(100000, intrinsics).setFixed(sharing == Sharing::fixedVertex);
  }
  std::vector<SE3<double>> truth;
  for (int i = 0; i < poses; ++i) {
    truth.emplace_back(SO3<double>::exp({0.02 * uniform(), 0.02 * uniform(), 0.02 * uniform()}),
                       Vector<double, 3>(0.5 * i, 0.2 * uniform(), 0.2 * uniform()));
    Vector<double, 6> off;
    for (int k = 0; k < 6; ++k) off[k] = 0.002 * uniform();
    graph.addVertex<VertexSE3>(i, truth.back().retract(off));
  }
  graph.findVertex(0)->setFixed(true);
  for (int j = 0; j < points; ++j) {
    const double z = 7.0 + 2.0 * uniform();
    const Vector<double, 3> at(0.5 * (poses - 1) * 0.5 * (1.0 + uniform()), 2.0 * uniform(), z);
    const Vector<double, 3> off(0.05 * uniform(), 0.05 * uniform(), 0.05 * uniform());
    graph.addVertex<VertexXYZ>(1000 + j, at + off);
    const int middle = static_cast<int>(at[0] / 0.5);
    for (int i = std::max(0, middle - 4); i < std::min(poses, middle + 4); ++i) {
      const Vector<double, 2> pixel =
          CameraPinhole::project<double>(intrinsics, truth[static_cast<std::size_t>(i)].actInverse(at)) +
          Vector<double, 2>(0.5 * uniform(), 0.5 * uniform());
      const Matrix<double, 2, 2> information = Matrix<double, 2, 2>::Identity();
      if (sharing == Sharing::parameter) {
        graph.addEdge<EdgeProjectPinhole>({i, 1000 + j}, pixel, information, {0});
      } else {
        graph.addEdge<EdgeProjectPinholeIntrinsics>({i, 1000 + j, 100000}, pixel, information);
      }
    }
  }
  return graph;
}

void compareSharing(int rounds, bench::JsonRows& json) {
  const auto registry = builtinRegistry();
  const Graph parameter = makeShared(registry, Sharing::parameter);
  const auto seconds = [](const Graph& start) {
    Graph graph(start);
    return bench::iterationSeconds(optimize(graph, bench::untilIterations(8)));
  };
  for (const Sharing sharing : {Sharing::fixedVertex, Sharing::freeVertex}) {
    const Graph shared = makeShared(registry, sharing);
    const bench::Pair pair = bench::comparePairs(
        rounds, [&] { return seconds(parameter); }, [&] { return seconds(shared); });
    const char* what = sharing == Sharing::fixedVertex ? "fixed" : "free";
    fmt::print(
        "intrinsics shared by {} edges as a {} vertex: an iteration {:.3f} ms, as a parameter {:.3f} ms, {:.2f}x\n",
        shared.edgeCount(), what, 1e3 * pair.theirs, 1e3 * pair.ours, pair.ratio);
    json.begin(std::string("shared intrinsics ") + what);
    json.add("seconds", pair.theirs);
    json.add("parameter_seconds", pair.ours);
    json.add("ratio", pair.ratio);
    std::fflush(stdout);
  }
}

// ---- many observations ----

/// Peak of the process's memory so far, in bytes.
double peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// What the process has in memory now.
double residentMemory() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  return file >> all >> resident ? resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) : peakMemory();
}

/// The solver that is chosen against those that can be asked for, over the same steps: medians of turns.
void compareSolvers(const Graph& start, int rounds, bench::JsonRows& json) {
  const std::array<std::string, 3> solvers{"auto", "block", "pcg"};
  std::array<std::vector<double>, 3> seconds;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < solvers.size(); ++i) {
      Graph graph(start);
      Options options = bench::untilIterations(3);
      options.linearSolver = solvers[i];
      double& sum = seconds[i].emplace_back(0.0);
      for (const IterationReport& report : optimize(graph, options).iterations) sum += report.seconds.total;
    }
  }
  std::array<double, 3> medians{};
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    medians[i] = bench::median(seconds[i]);
    fmt::print("3 steps with the solver {}: {:.3f} s\n", solvers[i], medians[i]);
    json.add(solvers[i] + "_seconds", medians[i]);
  }
  const double ofBest = medians[0] / std::min(medians[1], medians[2]);
  fmt::print("the chosen solver takes {:.2f} of the best forced one\n", ofBest);
  json.add("chosen_of_best", ofBest);
}

/// The command beside this program simulates the problem.
void measureLarge(const std::filesystem::path& program, int rounds, bench::JsonRows& json) {
  const char* const asked = std::getenv("QUIVER_BENCH_POINTS");
  const std::int64_t points = asked ? std::atoll(asked) : 250000;
  if (points <= 0) return;
  const std::int64_t cameras = std::max<std::int64_t>(10, points / 125);
  const auto command = program.parent_path() / "quiver";
  const std::string file =
      (std::filesystem::temp_directory_path() / fmt::format("quiver-bench-{}.bal", ::getpid())).string();
  const std::string line = fmt::format("'{}' simulate bundle -o '{}' --cameras {} --points {} > /dev/null",
                                       command.string(), file, cameras, points);
  if (std::system(line.c_str()) != 0) {
    fmt::print("the command {} is not built or failed: nothing is simulated\n", command.string());
    return;
  }
  const auto registry = builtinRegistry();
  double loadSeconds = 0.0;
  Graph graph(registry);
  loadSeconds = bench::secondsOf([&] { graph = readGraph(file, registry, {.threads = threads}); });
  const double loaded = peakMemory();
  const auto observations = static_cast<double>(graph.edgeCount());
  Summary summary;
  const Options options{.maxIterations = points > 1000000 ? 1 : 30, .algorithm = "lm", .threads = threads};
  const double resident = residentMemory();
  const double seconds = bench::secondsOf([&] { summary = optimize(graph, options); });
  const double measured = peakMemory() - resident;
  const double bytes = (peakMemory() - loaded) / observations;
  fmt::print(
      "{} cameras, {} points, {:.0f} observations: read in {:.2f} s, {} trial steps in {:.2f} s ({:.1f} ms each) "
      "with {}, chi2 {:.8g}, {}; {:.0f} bytes an observation above the {:.0f} MB after reading\n",
      cameras, points, observations, loadSeconds, summary.iterations.size(), seconds,
      1e3 * bench::iterationSeconds(summary), summary.plan.linearSolver, summary.finalChi2, toString(summary.status),
      bytes, 1e-6 * loaded);
  json.begin("simulated");
  json.add("observations", observations);
  json.add("load_seconds", loadSeconds);
  json.add("seconds", seconds);
  json.add("iteration_seconds", bench::iterationSeconds(summary));
  json.add("iterations", static_cast<double>(summary.iterations.size()));
  json.add("chi2", summary.finalChi2);
  json.add("bytes_per_observation", bytes);
  const auto predicted = static_cast<double>(estimateMemory(graph, options));
  fmt::print("estimateMemory: {:.0f} MB, measured {:.0f} MB, {:.2f} of it\n", 1e-6 * predicted, 1e-6 * measured,
             predicted / measured);
  json.add("estimated_bytes", predicted);
  json.add("estimated_of_measured", predicted / measured);
  if (points <= 1000000) compareSolvers(readGraph(file, registry, {.threads = threads}), std::min(rounds, 5), json);
  std::filesystem::remove(file);
}

}  // namespace

int main(int count, char** words) {
  bench::Arguments arguments(count, words, {});
  if (arguments.graphs.empty()) {
    const char* folder = std::getenv("QUIVER_DATA");
    const auto file = std::filesystem::path(folder ? folder : "../shared/data") / "ladybug-49-7776.txt";
    if (std::filesystem::exists(file)) arguments.graphs.push_back(file.string());
  }
  bench::JsonRows json;
  try {
    // Processes first: a child has none of the threads that its parent started. Then the large problem: the peak of a
    // process never falls.
    const std::vector<bench::PublishedWhole> wholes = bench::measureWholes(arguments.graphs, arguments.rounds);
    measureLarge(words[0], arguments.rounds, json);
    app::keepFreedMemory();
    bench::comparePublished(arguments.graphs, wholes, arguments.rounds, json);
    compareMotion(arguments.rounds, json);
    compareSharing(arguments.rounds, json);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  json.write(arguments.json);
}
