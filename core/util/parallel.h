#pragma once

#include <cstdint>

#include <quiver/core/util/function_ref.h>

namespace quiver {

/// The number of threads the machine offers, at least 1.
int hardwareThreads();

/// How many of `threads` threads a loop of about so many nanoseconds is worth: each must have more to do than calling
/// it in costs. At least 1.
int worthwhileThreads(int threads, double nanoseconds);

/// How many of `threads` threads could begin at once. The others sleep: waking them costs as much as some ten thousand
/// numbers, and more on a busy machine. It changes from moment to moment, so it may decide nothing but who does the
/// work.
int readyThreads(int threads);

/// Calls task(0) … task(count − 1), each exactly once, on at most `threads` threads, and returns when all are done.
///
/// Which thread runs which task is not fixed, so tasks must write to memory of their own; what a loop computes must
/// depend on `count` and the task's index alone, never on `threads`: then results have the same bits for any number of
/// threads. With threads ≤ 1 or count ≤ 1 it is a plain loop. The first exception a task throws is rethrown after all
/// tasks have ended (the remaining ones may be skipped). Calls do not nest: inside a task it is a plain loop.
void parallelFor(std::int64_t count, int threads, FunctionRef<void(std::int64_t)> task);

/// Calls task(i, worker) for i = 0 … count − 1, each exactly once, from at most `workers` workers that each own memory
/// numbered by `worker` (0 … workers − 1): tasks of one worker run one after the other. Which worker takes which task
/// is not fixed, so a worker's memory may hold nothing that outlives a task. Otherwise as parallelFor; takes the tasks
/// in ascending order.
void parallelForWorkers(std::int64_t count, int workers, int threads, FunctionRef<void(std::int64_t, int)> task);

}  // namespace quiver
