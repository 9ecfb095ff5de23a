// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scheduling/worker_pool.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "wire/error.h"

namespace curvereg::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMeanWeight = 0.1;           // of the newest task in the mean duration
constexpr double kUnknownTaskSeconds = 0.25;  // the mean, before there is one
constexpr double kMinRetrySeconds = 0.05;
constexpr double kMaxRetrySeconds = 30.0;

}  // namespace

// Locking: `mutex` guards everything here and the `place` of each task. It is never held while a function of a task
// runs, nor while a task is destroyed: that waits for a cancellation under way, which takes the mutex itself.
struct WorkerPool::State {
  struct Waiting;
  using WaitingPointer = std::shared_ptr<Waiting>;

  enum class Place { kOutside, kQueue, kGone };

  // Called by the stop token, on the thread that cancels.
  struct OnCancel {
    std::shared_ptr<State> state;
    std::weak_ptr<Waiting> waiting;
    void operator()() const;
  };

  struct Waiting {
    Task task;
    Clock::time_point submitted;
    Place place = Place::kOutside;
    std::optional<std::stop_callback<OnCancel>> on_cancel;
  };

  explicit State(const WorkerPoolOptions& pool_options) : options(pool_options) {
    if (options.num_workers <= 0)
      options.num_workers = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }

  // All with `mutex` held.
  absl::Status Refusal(const std::string& client) const;
  void Enqueue(const WaitingPointer& waiting);
  WaitingPointer TakeNext();
  void Remove(const Waiting& waiting);
  std::vector<WaitingPointer> TakeAll();
  bool IsIdle() const { return num_waiting == 0 && num_running == 0; }

  void Work();

  WorkerPoolOptions options;
  std::mutex mutex;
  std::condition_variable work_or_end;  // a task is waiting, or `ended`
  std::condition_variable idle;
  std::map<std::string, std::deque<WaitingPointer>> queues;  // of clients with tasks that wait; never an empty one
  std::list<std::string> turns;                              // the same clients, in the order of their turns
  int num_waiting = 0;
  int num_running = 0;
  double mean_task_seconds = 0.0;
  bool closed = false;  // to new tasks
  bool ended = false;   // workers leave when nothing waits
  std::vector<std::thread> threads;
  std::mutex join_mutex;  // guards joining; taken without `mutex`
};

absl::Status WorkerPool::State::Refusal(const std::string& client) const {
  if (closed) return wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop");
  const double task_seconds = mean_task_seconds > 0.0 ? mean_task_seconds : kUnknownTaskSeconds;
  const auto queue_time = [&](int length) {
    const double seconds = task_seconds * length / options.num_workers;
    return std::chrono::milliseconds(
        static_cast<int64_t>(1e3 * std::clamp(seconds, kMinRetrySeconds, kMaxRetrySeconds)));
  };
  const auto queue = queues.find(client);
  if (queue != queues.end() && static_cast<int>(queue->second.size()) >= options.max_queue_per_client) {
    return wire::WithRetryDelay(
        wire::MakeError(v1::ERROR_REASON_CLIENT_QUOTA, "this client has its share of the queue in use"),
        queue_time(options.max_queue_per_client));
  }
  if (num_waiting >= options.max_queue_length) {
    return wire::WithRetryDelay(wire::MakeError(v1::ERROR_REASON_QUEUE_FULL, "the queue of registrations is full"),
                                queue_time(num_waiting));
  }
  return absl::OkStatus();
}

void WorkerPool::State::Enqueue(const WaitingPointer& waiting) {
  std::deque<WaitingPointer>& queue = queues[waiting->task.client];
  if (queue.empty()) turns.push_back(waiting->task.client);
  queue.push_back(waiting);
  waiting->place = Place::kQueue;
  ++num_waiting;
}

// Precondition: a task is waiting.
WorkerPool::State::WaitingPointer WorkerPool::State::TakeNext() {
  const auto queue = queues.find(turns.front());
  turns.pop_front();
  WaitingPointer waiting = std::move(queue->second.front());
  queue->second.pop_front();
  if (queue->second.empty()) {
    queues.erase(queue);
  } else {
    turns.push_back(queue->first);
  }
  waiting->place = Place::kGone;
  --num_waiting;
  return waiting;
}

// Precondition: it is in a queue.
void WorkerPool::State::Remove(const Waiting& waiting) {
  const auto queue = queues.find(waiting.task.client);
  std::erase_if(queue->second, [&](const WaitingPointer& other) { return other.get() == &waiting; });
  if (queue->second.empty()) {
    turns.remove(queue->first);
    queues.erase(queue);
  }
  --num_waiting;
}

std::vector<WorkerPool::State::WaitingPointer> WorkerPool::State::TakeAll() {
  std::vector<WaitingPointer> all;
  while (num_waiting > 0) all.push_back(TakeNext());
  return all;
}

void WorkerPool::State::OnCancel::operator()() const {
  const WaitingPointer held = waiting.lock();  // keeps the task while it is dropped
  if (held == nullptr) return;
  const std::shared_ptr<State> held_state = state;
  {
    const std::lock_guard<std::mutex> lock(held_state->mutex);
    const Place place = std::exchange(held->place, Place::kGone);
    if (place != Place::kQueue) return;  // running, dropped, or not accepted yet: Submit will see
    held_state->Remove(*held);
    if (held_state->IsIdle()) held_state->idle.notify_all();
  }
  held->task.drop(wire::MakeError(v1::ERROR_REASON_CANCELLED, "cancelled while waiting"));
}

void WorkerPool::State::Work() {
  std::unique_lock<std::mutex> lock(mutex);
  for (;;) {
    work_or_end.wait(lock, [&] { return num_waiting > 0 || ended; });
    if (num_waiting == 0) return;
    WaitingPointer waiting = TakeNext();
    ++num_running;
    lock.unlock();

    waiting->on_cancel.reset();
    const Clock::time_point start = Clock::now();
    waiting->task.run(start - waiting->submitted);
    waiting.reset();  // with all that the task held
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();

    lock.lock();
    mean_task_seconds =
        mean_task_seconds == 0.0 ? seconds : (1.0 - kMeanWeight) * mean_task_seconds + kMeanWeight * seconds;
    --num_running;
    if (IsIdle()) idle.notify_all();
  }
}

WorkerPool::WorkerPool(const WorkerPoolOptions& options) : state_(std::make_shared<State>(options)) {
  for (int i = 0; i < state_->options.num_workers; ++i)
    state_->threads.emplace_back([state = state_] { state->Work(); });
}

WorkerPool::~WorkerPool() { Shutdown(Clock::now()); }

absl::Status WorkerPool::Submit(Task task) {
  const auto waiting = std::make_shared<State::Waiting>();
  waiting->task = std::move(task);
  waiting->submitted = Clock::now();
  // Before it is queued, for afterwards a worker may have it. A cancellation meanwhile is kept in its place.
  waiting->on_cancel.emplace(waiting->task.cancellation, State::OnCancel{state_, waiting});
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    if (absl::Status refusal = state_->Refusal(waiting->task.client); !refusal.ok()) return refusal;
    if (waiting->place == State::Place::kOutside) {
      state_->Enqueue(waiting);
      state_->work_or_end.notify_one();
      return absl::OkStatus();
    }
  }
  waiting->task.drop(wire::MakeError(v1::ERROR_REASON_CANCELLED, "cancelled before waiting"));
  return absl::OkStatus();
}

void WorkerPool::Shutdown(Clock::time_point deadline) {
  std::vector<State::WaitingPointer> dropped;
  {
    std::unique_lock<std::mutex> lock(state_->mutex);
    state_->closed = true;
    state_->idle.wait_until(lock, deadline, [&] { return state_->IsIdle(); });
    dropped = state_->TakeAll();
    state_->ended = true;
    state_->work_or_end.notify_all();
  }
  for (const State::WaitingPointer& waiting : dropped) {
    waiting->on_cancel.reset();
    waiting->task.drop(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server stopped before its turn came"));
  }
  const std::lock_guard<std::mutex> lock(state_->join_mutex);
  for (std::thread& thread : state_->threads) thread.join();
  state_->threads.clear();
}

WorkerPoolStatistics WorkerPool::Statistics() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return {.num_workers = state_->options.num_workers,
          .num_running = state_->num_running,
          .num_waiting = state_->num_waiting,
          .mean_task_seconds = state_->mean_task_seconds};
}

}  // namespace curvereg::server
