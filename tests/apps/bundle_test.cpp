#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/plugins/builtin.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class Bundle : public CommandTest {
 protected:
  /// The published ladybug problem, quoted for the shell; empty if it is not there.
  static std::string ladybug() {
    const std::string neighbour = publishedGraph("M3500");
    if (neighbour.empty()) return "";
    const auto path = std::filesystem::path(neighbour).parent_path() / "ladybug-49-7776.txt";
    return std::filesystem::exists(path) ? "'" + path.string() + "'" : "";
  }
  /// Σ eᵀΩe at the estimates of a file.
  double chi2(const std::string& file) const {
    return optimize(file + " --init file --iterations 0 --quiet")["initial_chi2"].get<double>();
  }
  Graph graph(const std::string& name) const { return readGraph((folder() / name).string(), builtinRegistry()); }
};

TEST_F(Bundle, LadybugFromTheFile) {
  const std::string file = ladybug();
  if (file.empty()) GTEST_SKIP() << whyMissing("ladybug-49-7776.txt");
  const Json report = optimize(file + " --iterations 20 --algorithm lm -o ladybug.bal");
  EXPECT_EQ(report["input"]["format"], "bal");
  EXPECT_NEAR(0.5 * report["initial_chi2"].get<double>(), 850912.46, 0.01);
  EXPECT_LE(0.5 * report["final_chi2"].get<double>(), 13346.0);
  EXPECT_LE(report["iterations"].size(), 20u);
  EXPECT_EQ(report["gauge"]["free"], 7);
  // A file holds the rotation's logarithm, the solver its matrix.
  EXPECT_NEAR(chi2("ladybug.bal"), report["final_chi2"].get<double>(), 1e-6);
}

TEST_F(Bundle, EverySubcommandTakesIt) {
  const std::string file = ladybug();
  if (file.empty()) GTEST_SKIP() << whyMissing("ladybug-49-7776.txt");
  EXPECT_EQ(run("convert " + file + " a.bal.gz").exitCode, 0);
  EXPECT_EQ(run("convert a.bal.gz a.g2o").exitCode, 0);
  EXPECT_EQ(run("convert a.g2o a.bal.bz2").exitCode, 0);
  EXPECT_EQ(run("convert - b.g2o < a.bal.bz2").exitCode, 0);
  EXPECT_EQ(run("convert " + file + " c.g2o").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("b.g2o"));
  EXPECT_EQ(read("a.g2o"), read("c.g2o"));
  const CommandResult info = run("info a.bal.gz");
  EXPECT_EQ(info.exitCode, 0);
  EXPECT_NE(info.out.find("49 VERTEX_CAMERA:BAL, 7776 VERTEX_TRACKXYZ"), std::string::npos) << info.out;
}

TEST_F(Bundle, WhatBalCannotHoldIsRefusedBeforeSolving) {
  write("square.g2o", square);
  for (const char* command : {"convert square.g2o out.bal", "optimize square.g2o -o out.bal"}) {
    const CommandResult result = run(command);
    EXPECT_EQ(result.exitCode, 6) << command;
    EXPECT_NE(result.err.find("VERTEX_SE2"), std::string::npos) << result.err;
    EXPECT_FALSE(exists("out.bal"));
  }
}

/// The text of a problem with two cameras; each line of `observations` is "camera point u v".
std::string twoCameras(const std::vector<std::string>& observations, const std::vector<std::string>& points) {
  std::ostringstream text;
  text << "2 " << points.size() << " " << observations.size() << "\n";
  for (const std::string& line : observations) text << line << "\n";
  text << "0 0 0 0 0 0 500 0 0\n0.01 -0.02 0.01 -1 0 0 500 0 0\n";
  for (const std::string& line : points) text << line << "\n";
  return text.str();
}

TEST_F(Bundle, OddPointsHaveADefinedResult) {
  // Seen once; behind both cameras; seen by nobody; and some that are as they should be.
  write("odd.bal",
        twoCameras({"0 0 10 20", "1 0 -90 20", "0 1 -30 40", "0 2 -30 -40", "1 2 70 -40", "0 4 100 50", "1 4 0 50",
                    "0 5 -100 -50", "1 5 -200 -50", "0 6 120 -80", "1 6 20 -80"},
                   {"0.1 0.2 -5", "-0.3 0.4 -5", "-0.3 0.4 5", "1 2 3", "1 0.5 -5", "-1 -0.5 -5", "1.2 -0.8 -5"}));
  const Json report = optimize("odd.bal -o out.g2o");
  EXPECT_TRUE(std::isfinite(report["final_chi2"].get<double>()));
  EXPECT_LT(report["final_chi2"].get<double>(), report["initial_chi2"].get<double>());
  // What nobody sees stays.
  EXPECT_NE(read("out.g2o").find("VERTEX_TRACKXYZ 5 1 2 3\n"), std::string::npos) << read("out.g2o");
}

TEST_F(Bundle, InfoCountsPointsBehindTheirCamera) {
  write("odd.bal", twoCameras({"0 0 10 20", "1 0 -90 20", "0 1 -30 -40", "1 1 70 -40"}, {"0.1 0.2 -5", "-0.3 0.4 5"}));
  const CommandResult result = run("info odd.bal --json info.json");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find("2 of 4 observations are of points behind their camera, the first EDGE_PROJECT_BAL [0,3]"),
            std::string::npos)
      << result.out;
  EXPECT_EQ(Json::parse(read("info.json"))["depth"]["behind_camera"], 2);
}

TEST_F(Bundle, ACameraWithoutPointsStays) {
  write("idle.bal", twoCameras({"0 0 10 20", "0 1 30 5"}, {"0.1 0.2 -5", "0.3 0.1 -5"}));
  const Json report = optimize("idle.bal -o out.bal");
  EXPECT_TRUE(std::isfinite(report["final_chi2"].get<double>()));
  const std::string text = read("out.bal");
  EXPECT_NE(text.find("\n0.01\n-0.02\n0.01\n-1\n0\n0\n500\n0\n0\n"), std::string::npos) << text;
}

TEST_F(Bundle, APointInTheCamerasPlaneIsNamed) {
  write("plane.bal", twoCameras({"0 0 10 20", "1 0 -90 20"}, {"0.1 0.2 0"}));
  const CommandResult result = run("optimize plane.bal");
  EXPECT_EQ(result.exitCode, 4);
  EXPECT_NE(result.err.find("EDGE_PROJECT_BAL 0 2 is not finite"), std::string::npos) << result.err;
}

TEST_F(Bundle, InfoReportsErrorsThatAreNotANumber) {
  write("in.bal", "1 2 2\n0 0 10 10\n0 1 1 1\n0\n0\n0\n0\n0\n0\n500\n0\n0\n0\n0\n0\n0.1\n0.2\n-3\n");
  const CommandResult told = run("info in.bal --json in.json");
  EXPECT_EQ(told.exitCode, 0) << told.err;
  EXPECT_NE(told.out.find("not a number because of 1 edge, the first EDGE_PROJECT_BAL 0 1"), std::string::npos)
      << told.out;
  const Json info = Json::parse(read("in.json"));
  EXPECT_TRUE(info["chi2"].is_null());
  ASSERT_EQ(info["undefined"].size(), 1u);
  EXPECT_EQ(info["undefined"][0]["vertices"], Json::array({0, 1}));
  EXPECT_EQ(info["worst_edges"].size(), 1u);
}

TEST_F(Bundle, EliminatesWithEverySolver) {
  ASSERT_EQ(run("simulate bundle -o in.bal --cameras 20 --points 400 --track-length 5").exitCode, 0);
  const Json list = Json::parse(run("list --json -").out);
  double least = 0.0;
  for (const Json& solver : list["linear_solvers"]) {
    const auto name = solver["name"].get<std::string>();
    if (name == "power") continue;  // as exact as its terms
    const Json report = optimize("in.bal --solver " + name + " --eliminate VERTEX_TRACKXYZ");
    EXPECT_EQ(report["elimination"]["eliminated"], 400) << name;
    EXPECT_EQ(report["status"], "converged") << name;
    if (least == 0.0) least = report["final_chi2"].get<double>();
    EXPECT_NEAR(report["final_chi2"].get<double>(), least, 1e-6 * least) << name;
  }
  EXPECT_GT(least, 0.0);
}

TEST_F(Bundle, WrongFilesAreRefusedWithTheirPlace) {
  write("nan.bal", twoCameras({"0 0 10 nan", "1 0 -90 20"}, {"0.1 0.2 -5"}));
  const CommandResult nan = run("optimize nan.bal");
  EXPECT_EQ(nan.exitCode, 3);
  EXPECT_EQ(nan.err.rfind("nan.bal:2:8:", 0), 0u) << nan.err;
  write("lie.bal", "2 1000000 2\n0 0 1 2\n1 0 3 4\n");
  const CommandResult lie = run("info lie.bal");
  EXPECT_EQ(lie.exitCode, 3);
  EXPECT_EQ(lie.err.rfind("lie.bal:1:1:", 0), 0u) << lie.err;
}

TEST_F(Bundle, SimulationIsTheSameForTheSameSeed) {
  ASSERT_EQ(run("simulate bundle -o a.bal --cameras 40 --points 3000 --threads 1 --truth a_truth.bal").exitCode, 0);
  ASSERT_EQ(run("simulate bundle -o b.bal --cameras 40 --points 3000 --threads 3").exitCode, 0);
  ASSERT_EQ(run("simulate bundle -o c.bal --cameras 40 --points 3000 --seed 1").exitCode, 0);
  EXPECT_EQ(read("a.bal"), read("b.bal"));
  EXPECT_NE(read("a.bal"), read("c.bal"));
  // The truth has the same observations.
  const std::string noisy = read("a.bal"), truth = read("a_truth.bal");
  const auto observations = static_cast<std::ptrdiff_t>(graph("a.bal").edgeCount());
  std::size_t end = 0;
  for (std::ptrdiff_t i = 0; i <= observations; ++i) end = noisy.find('\n', end) + 1;
  EXPECT_EQ(noisy.substr(0, end), truth.substr(0, end));
  EXPECT_NE(noisy.substr(end), truth.substr(end));
}

TEST_F(Bundle, SimulatedPixelsDeviateAsAsked) {
  for (const char* scene : {"loop", "city"}) {
    ASSERT_EQ(run(std::string("simulate bundle -o noisy.g2o --truth truth.g2o --cameras 60 --points 4000 --noise 0.8 "
                              "--track-length 5 --seed 11 --scene ") +
                  scene)
                  .exitCode,
              0);
    const Graph problem = graph("truth.g2o");
    const double numbers = 2.0 * static_cast<double>(problem.edgeCount());
    // chi2 of n squares of standard normal numbers: n ± √(2 n).
    EXPECT_NEAR(chi2("truth.g2o"), numbers, 5.0 * std::sqrt(2.0 * numbers)) << scene;
    const Json report = optimize("noisy.g2o --algorithm lm");
    const double freedom = numbers - (9.0 * 60 + 3.0 * 4000 - 7.0);
    EXPECT_NEAR(report["final_chi2"].get<double>(), freedom, 6.0 * std::sqrt(2.0 * freedom)) << scene;
  }
}

TEST_F(Bundle, SimulatedTracksAndOutliersAreAsAsked) {
  ASSERT_EQ(run("simulate bundle -o clean.bal --cameras 200 --points 5000 --track-length 4 --noise 0 "
                "--truth clean_truth.bal")
                .exitCode,
            0);
  const Graph clean = graph("clean.bal");
  EXPECT_NEAR(static_cast<double>(clean.edgeCount()) / 5000.0, 4.0, 0.25);
  EXPECT_LT(chi2("clean_truth.bal"), 1e-15 * static_cast<double>(clean.edgeCount()));
  std::vector<std::set<std::int64_t>> tracks(5200);
  clean.forEachEdge([&](const Edge& edge) {
    EXPECT_TRUE(tracks[static_cast<std::size_t>(edge.vertexId(1))].insert(edge.vertexId(0)).second);
  });
  for (std::size_t i = 200; i < tracks.size(); ++i) ASSERT_GE(tracks[i].size(), 2u);

  ASSERT_EQ(run("simulate bundle -o x.bal --cameras 200 --points 5000 --track-length 4 --noise 0 --outliers 0.1 "
                "--truth out_truth.bal")
                .exitCode,
            0);
  // A tenth of the pixels is anywhere in 1200 × 900: E (u − u')² = (1200² + 900²) / 12 · 2 if both are uniform.
  const double expected = 0.1 * static_cast<double>(clean.edgeCount()) * (1200.0 * 1200.0 + 900.0 * 900.0) / 6.0;
  EXPECT_NEAR(chi2("out_truth.bal") / expected, 1.0, 0.25);
}

/// The numbers of "TITLE: b blocks, u unknowns a side; s blocks stored, n numbers, …" in a text.
struct Figures {
  long blocks = 0, unknowns = 0, stored = 0, numbers = 0;
};
Figures figuresOf(const std::string& text, const std::string& title) {
  Figures f;
  const std::size_t at = text.find(title);
  if (at == std::string::npos) return f;
  std::sscanf(text.c_str() + text.find(": ", at), ": %ld blocks, %ld unknowns a side; %ld blocks stored, %ld numbers",
              &f.blocks, &f.unknowns, &f.stored, &f.numbers);
  return f;
}

TEST_F(Bundle, StructureOfTheMatrices) {
  ASSERT_EQ(run("simulate bundle -o p.bal --cameras 30 --points 600 --scene city").exitCode, 0);
  const CommandResult result = run("plot p.bal --structure -o s.svg");
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const Graph problem = graph("p.bal");
  std::map<std::int64_t, std::set<std::int64_t>> tracks;
  std::set<std::pair<std::int64_t, std::int64_t>> seen, covisible;
  problem.forEachEdge([&](const Edge& edge) {
    seen.emplace(edge.vertexId(0), edge.vertexId(1));
    tracks[edge.vertexId(1)].insert(edge.vertexId(0));
  });
  std::set<std::int64_t> cameras;
  for (const auto& [point, track] : tracks) {
    cameras.insert(track.begin(), track.end());
    for (const std::int64_t a : track) {
      for (const std::int64_t b : track) covisible.emplace(a, b);
    }
  }
  const auto c = static_cast<long>(cameras.size()), p = static_cast<long>(tracks.size());
  const auto edges = static_cast<long>(seen.size()), shared = static_cast<long>(covisible.size());
  const Figures whole = figuresOf(result.out, "H, eliminated vertices last");
  EXPECT_EQ(whole.blocks, c + p) << result.out;
  EXPECT_EQ(whole.unknowns, 9 * c + 3 * p);
  EXPECT_EQ(whole.stored, c + p + 2 * edges);
  EXPECT_EQ(whole.numbers, 81 * c + 9 * p + 2 * 27 * edges);
  const Figures reduced = figuresOf(result.out, "reduced matrix");
  EXPECT_EQ(reduced.blocks, c);
  EXPECT_EQ(reduced.stored, shared);
  EXPECT_EQ(reduced.numbers, 81 * shared);
  const Figures factor = figuresOf(result.out, "Cholesky factor");
  EXPECT_GE(factor.stored, (shared + c) / 2);
  EXPECT_LE(factor.stored, c * (c + 1) / 2);
  const std::string svg = read("s.svg");
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  EXPECT_NE(svg.find("reduced matrix"), std::string::npos);
}

TEST_F(Bundle, SimulationRefusesNonsense) {
  for (const char* flags :
       {"--cameras 1", "--points 0", "--track-length 1", "--outliers 2", "--noise -1", "--rounds 0", "--scene moon"}) {
    const CommandResult result = run(std::string("simulate bundle -o x.bal ") + flags);
    EXPECT_EQ(result.exitCode, 2) << flags << result.err;
    EXPECT_FALSE(exists("x.bal")) << flags;
  }
}

}  // namespace
}  // namespace quiver::test
