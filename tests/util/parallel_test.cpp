#include <quiver/core/util/parallel.h>

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace quiver::test {
namespace {

TEST(ParallelFor, callsEveryTaskOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    for (const int count : {0, 1, 2, 7, 100, 1000}) {
      std::vector<int> calls(static_cast<std::size_t>(count), 0);
      parallelFor(count, threads, [&](std::int64_t i) { ++calls[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(std::accumulate(calls.begin(), calls.end(), 0), count);
      EXPECT_EQ(calls, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
  }
}

TEST(ParallelFor, nestedLoopsArePlainLoops) {
  std::vector<int> calls(64, 0);
  parallelFor(8, 2, [&](std::int64_t i) {
    parallelFor(8, 2, [&](std::int64_t j) { ++calls[static_cast<std::size_t>(8 * i + j)]; });
  });
  EXPECT_EQ(calls, std::vector<int>(64, 1));
}

TEST(ParallelFor, rethrowsAnException) {
  for (const int threads : {1, 2}) {
    EXPECT_THROW(parallelFor(50, threads,
                             [](std::int64_t i) {
                               if (i == 17) throw std::runtime_error("17");
                             }),
                 std::runtime_error);
    int sum = 0;
    parallelFor(3, 1, [&](std::int64_t i) { sum += static_cast<int>(i); });
    EXPECT_EQ(sum, 3) << "loops work after one";
  }
}

TEST(WorthwhileThreads, growWithTheWork) {
  EXPECT_EQ(worthwhileThreads(8, 0.0), 1);
  EXPECT_EQ(worthwhileThreads(8, 1.9e4), 1);
  EXPECT_EQ(worthwhileThreads(8, 4.1e4), 4);
  EXPECT_EQ(worthwhileThreads(8, 1e12), 8);
  EXPECT_EQ(worthwhileThreads(0, 1e12), 1);
}

TEST(ParallelForWorkers, givesEveryTaskToOneWorkerAtATime) {
  for (const int threads : {1, 2, 3}) {
    for (const int workers : {1, 2, 5}) {
      std::vector<int> calls(300, 0);
      std::vector<std::atomic<int>> busy(static_cast<std::size_t>(workers));
      std::atomic<bool> shared{false};
      parallelForWorkers(300, workers, threads, [&](std::int64_t i, int worker) {
        if (busy[static_cast<std::size_t>(worker)]++ != 0) shared = true;
        ++calls[static_cast<std::size_t>(i)];
        --busy[static_cast<std::size_t>(worker)];
      });
      EXPECT_EQ(calls, std::vector<int>(300, 1));
      EXPECT_FALSE(shared) << "two tasks in one worker's memory";
    }
  }
}

TEST(ParallelFor, severalCallersShareThePool) {
  std::vector<std::vector<int>> calls(4, std::vector<int>(200, 0));
  std::vector<std::thread> callers;
  for (auto& own : calls) {
    callers.emplace_back([&own] {
      for (int round = 0; round < 50; ++round) {
        parallelFor(200, 2, [&](std::int64_t i) { ++own[static_cast<std::size_t>(i)]; });
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const auto& own : calls) EXPECT_EQ(own, std::vector<int>(200, 50));
}

}  // namespace
}  // namespace quiver::test
