// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The only door to threads. Stages call ParallelFor with a number of tasks that does not depend on the thread count
// and join their results in task order, so the same input gives the same bytes on 1, 2 or any number of threads.
#ifndef CURVEREG_CORE_BASE_PARALLEL_H_
#define CURVEREG_CORE_BASE_PARALLEL_H_

#include <functional>

namespace curvereg {

// Runs `body` with at most `num_threads` threads (this one included) for every ParallelFor it calls, nested ones too.
// num_threads 0 means one per processor. Blocks until done.
void WithThreadLimit(int num_threads, const std::function<void()>& body);

// Calls task(i) once for each i in [0, num_tasks), in any order and on any thread of the innermost WithThreadLimit
// (outside of one: serially, on this thread). Blocks until all are done. Tasks must not throw; may nest.
void ParallelFor(int num_tasks, const std::function<void(int)>& task);

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_PARALLEL_H_
