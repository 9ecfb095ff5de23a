// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The threads that compute. A bounded queue, taken from in turn client by client, so that one client's backlog does not
// hold up the others.
#ifndef CURVEREG_SERVER_SCHEDULING_WORKER_POOL_H_
#define CURVEREG_SERVER_SCHEDULING_WORKER_POOL_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/status.h"

namespace curvereg::server {

struct WorkerPoolOptions {
  int num_workers = 0;            // threads, and so tasks that run at once; 0: one per processor
  int max_queue_length = 64;      // tasks that wait, of all clients; beyond it QUEUE_FULL
  int max_queue_per_client = 16;  // beyond it CLIENT_QUOTA
};

struct WorkerPoolStatistics {
  int num_workers = 0;
  int num_running = 0;
  int num_waiting = 0;
  double mean_task_seconds = 0.0;  // of recent tasks; 0 before the first
};

class WorkerPool {
 public:
  // What is to be done. Exactly one of the two is called, once, on a worker's thread or on the thread that cancels.
  struct Task {
    std::string client;                                 // whose turn it takes
    std::stop_token cancellation;                       // at its request a waiting task is dropped at once
    std::function<void(std::chrono::nanoseconds)> run;  // told how long it waited
    std::function<void(const absl::Status&)> drop;      // CANCELLED, or NOT_SERVING at shutdown
  };

  explicit WorkerPool(const WorkerPoolOptions& options);
  ~WorkerPool();  // Shutdown(0)
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // Takes the task on or refuses it: QUEUE_FULL, CLIENT_QUOTA (both with a RetryInfo made from the length of the queue
  // and the mean duration of tasks), NOT_SERVING after Shutdown. A refused task's functions are not called.
  absl::Status Submit(Task task);

  // Refuses new tasks, lets those that wait and run finish until `deadline`, drops what still waits then, and joins the
  // threads (a running task is waited for: cancelling it is its owner's business). Idempotent.
  void Shutdown(std::chrono::steady_clock::time_point deadline);

  WorkerPoolStatistics Statistics() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCHEDULING_WORKER_POOL_H_
