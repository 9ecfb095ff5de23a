// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/prepared_scan_cache.h"

#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "wire/error.h"

namespace curvereg::server {
namespace {

using ScanPointer = std::shared_ptr<const PreparedScan>;
using Result = absl::StatusOr<ScanPointer>;

struct Entry {
  std::string name;
  ScanPointer scan;
  uint64_t bytes = 0;
};

// One call of a loader; those who wait for it hold it, too.
struct Loading {
  std::optional<Result> result;  // set at the end; a stopped loader leaves CANCELLED or DEADLINE_EXCEEDED
  bool is_wanted = true;         // false after Erase: what comes is not kept
};

bool WasStopped(const Result& result) {
  return absl::IsCancelled(result.status()) || absl::IsDeadlineExceeded(result.status());
}

absl::Status StoppedStatus(const Stop& stop) {
  if (stop.Cancelled()) return wire::MakeError(v1::ERROR_REASON_CANCELLED, "cancelled while a scan was prepared");
  return wire::MakeError(v1::ERROR_REASON_DEADLINE_EXCEEDED, "time ran out while a scan was prepared");
}

}  // namespace

struct PreparedScanCache::State {
  using Lock = std::unique_lock<std::mutex>;

  // All with `mutex` held.
  ScanPointer Find(const std::string& name);
  void Insert(const std::string& name, const ScanPointer& scan, std::vector<ScanPointer>& removed);
  void Remove(std::list<Entry>::iterator entry, std::vector<ScanPointer>& removed);
  void Evict(std::vector<ScanPointer>& removed);
  void WaitFor(const Loading& loading, Lock& lock, const Stop& stop);

  Result Load(const std::string& name, const Loader& load, const Stop& stop, Lock& lock);
  void EndLoading(const std::string& name, const std::shared_ptr<Loading>& loading, Result result);

  uint64_t max_bytes = 0;
  mutable std::mutex mutex;
  std::condition_variable_any loading_ended;
  std::list<Entry> entries;  // most recently used first
  std::map<std::string, std::list<Entry>::iterator> by_name;
  std::map<std::string, std::shared_ptr<Loading>> loadings;
  Statistics statistics;
};

ScanPointer PreparedScanCache::State::Find(const std::string& name) {
  const auto found = by_name.find(name);
  if (found == by_name.end()) return nullptr;
  entries.splice(entries.begin(), entries, found->second);
  return found->second->scan;
}

void PreparedScanCache::State::Insert(const std::string& name, const ScanPointer& scan,
                                      std::vector<ScanPointer>& removed) {
  const uint64_t bytes = scan->MemoryBytes();
  if (bytes > max_bytes) return;
  entries.push_front({name, scan, bytes});
  by_name[name] = entries.begin();
  statistics.bytes += bytes;
  Evict(removed);
}

void PreparedScanCache::State::Remove(std::list<Entry>::iterator entry, std::vector<ScanPointer>& removed) {
  statistics.bytes -= entry->bytes;
  removed.push_back(std::move(entry->scan));
  by_name.erase(entry->name);
  entries.erase(entry);
}

void PreparedScanCache::State::Evict(std::vector<ScanPointer>& removed) {
  while (statistics.bytes > max_bytes) {
    Remove(std::prev(entries.end()), removed);
    ++statistics.num_evictions;
  }
}

void PreparedScanCache::State::WaitFor(const Loading& loading, Lock& lock, const Stop& stop) {
  const auto ended = [&] { return loading.result.has_value(); };
  if (stop.deadline.has_value()) {
    loading_ended.wait_until(lock, stop.cancellation, *stop.deadline, ended);
  } else {
    loading_ended.wait(lock, stop.cancellation, ended);
  }
}

// Takes and gives back the lock.
Result PreparedScanCache::State::Load(const std::string& name, const Loader& load, const Stop& stop, Lock& lock) {
  ++statistics.num_misses;
  const auto loading = std::make_shared<Loading>();
  loadings[name] = loading;
  lock.unlock();
  // Whatever ends the loader, even lack of memory as an exception, those who wait must go on.
  struct Ending {
    State& state;
    const std::string& name;
    const std::shared_ptr<Loading>& loading;
    Result result = absl::CancelledError("the loader did not return");
    ~Ending() { state.EndLoading(name, loading, result); }
  } ending{*this, name, loading};
  absl::StatusOr<std::unique_ptr<const PreparedScan>> loaded = load(stop);
  ending.result = loaded.ok() ? Result(ScanPointer(*std::move(loaded))) : Result(loaded.status());
  return ending.result;
}

void PreparedScanCache::State::EndLoading(const std::string& name, const std::shared_ptr<Loading>& loading,
                                          Result result) {
  std::vector<ScanPointer> removed;  // freed after the lock
  const Lock lock(mutex);
  if (loading->is_wanted) {
    loadings.erase(name);
    if (result.ok()) Insert(name, *result, removed);
  }
  loading->result = std::move(result);
  loading_ended.notify_all();
}

PreparedScanCache::PreparedScanCache(uint64_t max_bytes) : state_(std::make_unique<State>()) {
  state_->max_bytes = max_bytes;
}

PreparedScanCache::~PreparedScanCache() = default;

absl::StatusOr<ScanPointer> PreparedScanCache::Get(const std::string& name, const Loader& load, const Stop& stop) {
  State::Lock lock(state_->mutex);
  for (;;) {
    if (ScanPointer scan = state_->Find(name); scan != nullptr) {
      ++state_->statistics.num_hits;
      return scan;
    }
    const auto found = state_->loadings.find(name);
    if (found == state_->loadings.end()) return state_->Load(name, load, stop, lock);
    const std::shared_ptr<Loading> loading = found->second;
    state_->WaitFor(*loading, lock, stop);
    if (!loading->result.has_value()) return StoppedStatus(stop);
    if (WasStopped(*loading->result)) continue;  // take over
    if (loading->result->ok()) ++state_->statistics.num_hits;
    return *loading->result;
  }
}

ScanPointer PreparedScanCache::Find(const std::string& name) {
  const State::Lock lock(state_->mutex);
  ScanPointer scan = state_->Find(name);
  if (scan != nullptr) ++state_->statistics.num_hits;
  return scan;
}

void PreparedScanCache::Erase(const std::string& name) {
  std::vector<ScanPointer> removed;
  const State::Lock lock(state_->mutex);
  if (const auto found = state_->by_name.find(name); found != state_->by_name.end()) {
    state_->Remove(found->second, removed);
  }
  if (const auto found = state_->loadings.find(name); found != state_->loadings.end()) {
    found->second->is_wanted = false;
    state_->loadings.erase(found);
  }
}

void PreparedScanCache::UpdateSize(const std::string& name) {
  std::vector<ScanPointer> removed;
  const State::Lock lock(state_->mutex);
  const auto found = state_->by_name.find(name);
  if (found == state_->by_name.end()) return;
  Entry& entry = *found->second;
  const uint64_t bytes = entry.scan->MemoryBytes();
  state_->statistics.bytes += bytes - entry.bytes;  // modulo 2^64 where it shrank
  entry.bytes = bytes;
  if (bytes > state_->max_bytes) {
    state_->Remove(found->second, removed);
    ++state_->statistics.num_evictions;
  }
  state_->Evict(removed);
}

PreparedScanCache::Statistics PreparedScanCache::GetStatistics() const {
  const State::Lock lock(state_->mutex);
  Statistics statistics = state_->statistics;
  statistics.num_entries = state_->entries.size();
  return statistics;
}

}  // namespace curvereg::server
