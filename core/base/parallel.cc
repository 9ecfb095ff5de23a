// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#if defined(CURVEREG_TELL_TSAN)
// Neither TBB nor this file, into which its headers are compiled, is instrumented: ThreadSanitizer is told here that
// what precedes a fork comes before its tasks, and these before what follows the join.
#include <sanitizer/tsan_interface.h>
#define CURVEREG_TSAN_ACQUIRE(address) __tsan_acquire(address)
#define CURVEREG_TSAN_RELEASE(address) __tsan_release(address)
#else
#define CURVEREG_TSAN_ACQUIRE(address) static_cast<void>(address)
#define CURVEREG_TSAN_RELEASE(address) static_cast<void>(address)
#endif

namespace curvereg {
namespace {

// Whether this thread works inside a WithThreadLimit of more than one thread.
thread_local bool t_parallel = false;

class ScopedParallel {
 public:
  explicit ScopedParallel(bool value) : previous_(t_parallel) { t_parallel = value; }
  ~ScopedParallel() { t_parallel = previous_; }
  ScopedParallel(const ScopedParallel&) = delete;
  ScopedParallel& operator=(const ScopedParallel&) = delete;

 private:
  bool previous_;
};

}  // namespace

void WithThreadLimit(int num_threads, const std::function<void()>& body) {
  if (num_threads == 1) {
    const ScopedParallel serial(false);
    body();
    return;
  }
  tbb::task_arena arena(num_threads > 0 ? num_threads : tbb::task_arena::automatic);
  int fork = 0;
  int join = 0;
  CURVEREG_TSAN_RELEASE(&fork);
  // On this thread or, when the arena is full, on another.
  arena.execute([&] {
    CURVEREG_TSAN_ACQUIRE(&fork);
    const ScopedParallel parallel(true);
    body();
    CURVEREG_TSAN_RELEASE(&join);
  });
  CURVEREG_TSAN_ACQUIRE(&join);
}

void ParallelFor(int num_tasks, const std::function<void(int)>& task) {
  if (!t_parallel || num_tasks <= 1) {
    for (int i = 0; i < num_tasks; ++i) task(i);
    return;
  }
  int fork = 0;
  int join = 0;
  CURVEREG_TSAN_RELEASE(&fork);
  // Isolated: while it waits, this thread takes no task of an outer loop, which could need a lock that it holds.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        0, num_tasks, 1,
        [&](int i) {
          CURVEREG_TSAN_ACQUIRE(&fork);
          const ScopedParallel parallel(true);
          task(i);
          CURVEREG_TSAN_RELEASE(&join);
        },
        tbb::simple_partitioner());
  });
  CURVEREG_TSAN_ACQUIRE(&join);
}

}  // namespace curvereg
