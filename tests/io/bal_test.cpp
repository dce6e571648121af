#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include <quiver/core/io/bal/bal_format.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_sba/edge_project_bal.h>
#include <tests/io/temporary_folder.h>

namespace quiver {
namespace {

using test::TemporaryFolder;

Graph read(const std::string& text, int threads = 1) {
  return readGraphText(text, "problem.bal", builtinRegistry(), {.threads = threads});
}

ParseError refusal(const std::string& text) {
  try {
    read(text);
  } catch (const ParseError& error) {
    return error;
  }
  return ParseError("accepted", 0, 0, "");
}

/// Two cameras and three points; point 2 is seen once, point 1 twice, point 0 twice.
std::string smallProblem(const std::string& separator = "\n") {
  std::string text = "2 3 5" + separator;
  for (const char* observation : {"0 0 -1.5 2.5", "1 0 3 4", "0 1 1e1 -7.25", "1 1 0.5 0.25", "1 2 8 9"})
    text += observation + separator;
  for (int i = 0; i < 18; ++i) text += std::to_string(0.01 * (i + 1)) + separator;
  for (int i = 0; i < 9; ++i) text += std::to_string(1 + i) + ".5" + separator;
  return text;
}

TEST(Bal, IsToldByItsFirstToken) {
  EXPECT_TRUE(detail::looksLikeBal("49 7776 31843\n0 0 1 2\n"));
  EXPECT_TRUE(detail::looksLikeBal("\xef\xbb\xbf \n 2 3 5"));
  EXPECT_TRUE(detail::looksLikeBal("7"));
  EXPECT_FALSE(detail::looksLikeBal(""));
  EXPECT_FALSE(detail::looksLikeBal("VERTEX_SE2 0 0 0 0\n"));
  EXPECT_FALSE(detail::looksLikeBal("# 49 7776 31843\n"));
  EXPECT_FALSE(detail::looksLikeBal("7zip"));
  for (const char* path : {"a.bal", "a.bal.gz", "x/a.bal.bz2"}) EXPECT_EQ(formatOfPath(path), GraphFormat::bal) << path;
  for (const char* path : {"a.g2o", "a.bal.g2o", "bal", "-", "a.gz"})
    EXPECT_EQ(formatOfPath(path), GraphFormat::g2o) << path;
}

TEST(Bal, CamerasComeFirstThenPoints) {
  const Graph graph = read(smallProblem());
  EXPECT_EQ(graph.vertexCount(), 5);
  EXPECT_EQ(graph.edgeCount(), 5);
  const std::array<double, 9> numbers = graph.vertex<VertexCameraBal>(1).numbers();
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(numbers[i], std::stod(std::to_string(0.01 * static_cast<double>(i + 10))));
  EXPECT_EQ(graph.vertex<VertexXYZ>(4).estimate(), (Vector<double, 3>(7.5, 8.5, 9.5)));
  int observation = 0;
  graph.forEachEdge([&](const Edge& edge) {
    if (observation++ != 2) return;
    EXPECT_EQ(edge.vertexId(0), 0);
    EXPECT_EQ(edge.vertexId(1), 3);
    EXPECT_EQ(static_cast<const EdgeProjectBal&>(edge).measurement(), (Vector<double, 2>(10.0, -7.25)));
    EXPECT_TRUE((static_cast<const EdgeProjectBal&>(edge).information().isIdentity(0.0)));
  });
}

/// The slow twin: std::istream over the text.
void expectAsStream(const std::string& text, const Graph& graph) {
  std::istringstream in(text);
  std::int64_t cameras = 0, points = 0, observations = 0;
  in >> cameras >> points >> observations;
  ASSERT_EQ(graph.vertexCount(), cameras + points);
  ASSERT_EQ(graph.edgeCount(), observations);
  graph.forEachEdge([&](const Edge& edge) {
    std::int64_t camera = 0, point = 0;
    double u = 0, v = 0;
    in >> camera >> point >> u >> v;
    ASSERT_EQ(edge.vertexId(0), camera);
    ASSERT_EQ(edge.vertexId(1), cameras + point);
    ASSERT_EQ(static_cast<const EdgeProjectBal&>(edge).measurement(), (Vector<double, 2>(u, v)));
  });
  for (std::int64_t i = 0; i < cameras; ++i) {
    for (const double number : graph.vertex<VertexCameraBal>(i).numbers()) {
      double expected = 0;
      in >> expected;
      ASSERT_EQ(number, expected) << "camera " << i;
    }
  }
  for (std::int64_t i = 0; i < points; ++i) {
    for (int k = 0; k < 3; ++k) {
      double expected = 0;
      in >> expected;
      ASSERT_EQ(graph.vertex<VertexXYZ>(cameras + i).estimate()[k], expected) << "point " << i;
    }
  }
}

std::string randomProblem(int cameras, int points, int observations, bool odd) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::ostringstream out;
  out.precision(17);
  out << cameras << " " << points << " " << observations << "\n";
  for (int i = 0; i < observations; ++i) {
    out << random() % static_cast<unsigned>(cameras) << (odd && i % 3 == 0 ? "\n" : "\t ")
        << random() % static_cast<unsigned>(points) << "     " << 500 * uniform(random) << " " << 500 * uniform(random)
        << (odd && i % 5 == 0 ? " " : "\r\n");
  }
  for (int i = 0; i < 9 * cameras + 3 * points; ++i) out << uniform(random) << (odd && i % 4 ? "  " : "\n");
  return out.str();
}

TEST(Bal, ReadsWhatAStreamReads) {
  expectAsStream(smallProblem(), read(smallProblem()));
  expectAsStream(smallProblem(" "), read(smallProblem(" ")));
  const std::string regular = randomProblem(30, 2000, 20000, false), odd = randomProblem(30, 2000, 20000, true);
  for (const int threads : {1, 4}) {
    expectAsStream(regular, read(regular, threads));
    expectAsStream(odd, read(odd, threads));
  }
}

TEST(Bal, ConversionLosesNothing) {
  const TemporaryFolder folder;
  const Graph graph = read(randomProblem(5, 40, 200, false));
  const std::string g2o = graphText(graph);
  for (const char* name : {"a.bal", "a.bal.gz", "a.bal.bz2"}) {
    const std::string path = folder.path(name);
    writeGraph(path, graph);
    ReadReport report;
    const Graph again = readGraph(path, builtinRegistry(), {.report = &report});
    EXPECT_EQ(report.format, "bal");
    EXPECT_EQ(graphText(again), g2o) << name;
  }
  const Graph throughG2o = readGraphText(g2o, "a.g2o", builtinRegistry());
  writeGraph(folder.path("b.bal"), throughG2o);
  const auto content = [&](const char* name) {
    std::ifstream in(folder.path(name));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(content("a.bal"), content("b.bal"));
}

TEST(Bal, ErrorsHaveAPlace) {
  const std::string small = smallProblem();
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = small;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const ParseError nan = refusal(replaced("0.5 0.25", "nan 0.25"));
  EXPECT_EQ(nan.line(), 5);
  EXPECT_EQ(nan.column(), 5);
  const ParseError camera = refusal(replaced("1 2 8 9", "2 2 8 9"));
  EXPECT_EQ(camera.line(), 6);
  EXPECT_EQ(camera.column(), 1);
  EXPECT_NE(camera.message().find("camera 2 does not exist: the header promises 2"), std::string::npos)
      << camera.what();
  const ParseError point = refusal(replaced("1 2 8 9", "1 -2 8 9"));
  EXPECT_EQ(point.column(), 3);
  EXPECT_NE(point.message().find("point -2"), std::string::npos) << point.what();
  const ParseError word = refusal(replaced("1 2 8 9", "1 2 8 x"));
  EXPECT_EQ(word.line(), 6);
  EXPECT_EQ(word.column(), 7);
  const ParseError fraction = refusal(replaced("1 2 8 9", "1.5 2 8 9"));
  EXPECT_EQ(fraction.line(), 6);
}

TEST(Bal, ARotationVectorWithoutASineIsRefused) {
  const std::string cameras = "2 1 1\n1 0 1 2\n0 0 0 0 0 0 1 0 0\n";
  EXPECT_STREQ(refusal(cameras + "1e200 1e200 0 0 0 0 1 0 0\n1 2 3\n").what(),
               "problem.bal:4:13: this rotation vector is too long");
  EXPECT_STREQ(refusal("VERTEX_CAMERA:BAL 0 1e200 1e200 0 0 0 0 1 0 0\n").what(),
               "problem.bal:1:33: this rotation vector is too long");
  EXPECT_EQ(read(cameras + "1e100 1e100 0 0 0 0 1 0 0\n1 2 3\n").vertexCount(), 3);
}

TEST(Bal, HeadersThatLie) {
  const std::string small = smallProblem();
  const auto withHeader = [&](const std::string& header) { return header + small.substr(small.find('\n')); };
  // Too much is promised: found at the end, or before memory is reserved.
  EXPECT_EQ(refusal(withHeader("2 3 6")).line(), 7);  // where a camera's number stands, no index
  const ParseError missing = refusal(withHeader("2 4 5"));
  EXPECT_NE(missing.message().find("number 1 of point 3 is missing"), std::string::npos) << missing.what();
  EXPECT_EQ(missing.line(), 34);
  for (const char* header : {"2000000000 3 5", "2 2000000000 5", "2 3 2000000000", "9223372036854775807 3 5",
                             "2 3 99999999999999999999", "-1 3 5", "2 3", "0 0 0", "1e3 3 5"}) {
    const ParseError error = refusal(withHeader(header));
    EXPECT_EQ(error.file(), "problem.bal") << header;
    EXPECT_GE(error.line(), 1) << header;
  }
  EXPECT_NE(refusal(withHeader("2 3 2000000000")).message().find("bytes follow"), std::string::npos);
  // Too little: numbers are left over.
  const ParseError more = refusal(withHeader("2 2 5"));
  EXPECT_EQ(more.file(), "problem.bal");
  EXPECT_EQ(refusal(small + "7\n").line(), 34);
  EXPECT_NE(refusal(small + "7\n").message().find("goes on"), std::string::npos);
  EXPECT_EQ(read(small + " \n\n").edgeCount(), 5);
}

TEST(Bal, CutAnywhereIsRefused) {
  const std::string small = smallProblem();
  const std::size_t last = small.find_last_not_of("\n");
  for (std::size_t length = 1; length < last; ++length) {
    const std::string cut = small.substr(0, length);
    // Cutting digits off the last number alone leaves a problem.
    if (length > small.rfind('\n', last)) continue;
    EXPECT_EQ(refusal(cut).file(), "problem.bal") << length;
  }
}

TEST(Bal, ATruncatedArchiveIsRefused) {
  const TemporaryFolder folder;
  writeGraph(folder.path("a.bal.bz2"), read(randomProblem(5, 400, 2000, false)));
  std::ifstream in(folder.path("a.bal.bz2"), std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(in), {});
  std::ofstream(folder.path("cut.bal.bz2"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_THROW(readGraph(folder.path("cut.bal.bz2"), builtinRegistry()), ParseError);
}

TEST(Bal, OnlyProblemsOfItsKindAreWritten) {
  const auto refused = [](Graph& graph) {
    try {
      checkFormat("x.bal.gz", graph);
    } catch (const GraphError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Graph problem = read(smallProblem());
  Graph copy = problem;
  EXPECT_EQ(refused(copy), "");
  copy.findVertex(0)->setFixed(true);
  EXPECT_NE(refused(copy).find("fixed"), std::string::npos);
  copy = problem;
  copy.findVertex(3)->setHasEstimate(false);
  EXPECT_NE(refused(copy).find("estimate"), std::string::npos);
  copy = problem;
  copy.addEdge<EdgeProjectBal>({0, 4}, {1.0, 2.0}, 2.0 * Matrix<double, 2, 2>::Identity());
  EXPECT_NE(refused(copy).find("information"), std::string::npos);
  Graph poses = readGraphText("VERTEX_SE2 0 0 0 0\n", "a.g2o", builtinRegistry());
  EXPECT_NE(refused(poses).find("VERTEX_SE2"), std::string::npos);
  checkFormat("x.g2o", poses);
}

TEST(Bal, CamerasAndPointsThatNothingSeesAreKept) {
  const Graph graph =
      read("2 2 1\n0 0 1 2\n" + std::string("0 0 0 0 0 -1 500 0 0\n0 0 0 0 0 -1 500 0 0\n0 0 -5\n1 1 1\n"));
  EXPECT_EQ(graph.vertexCount(), 4);
  EXPECT_EQ(graph.edgeCount(), 1);
}

}  // namespace
}  // namespace quiver
