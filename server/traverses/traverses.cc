// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverses.h"

#include <google/protobuf/util/message_differencer.h>

#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/scheduling/delayed_calls.h"
#include "server/store/page_token.h"
#include "server/tracking/scan_uses.h"
#include "server/tracking/traverse_conversion.h"
#include "server/tracking/traverse_engine.h"
#include "server/tracking/traverse_store.h"
#include "server/tracking/traverse_watchers.h"
#include "server/traverses/streamed_upload.h"
#include "wire/error.h"
#include "wire/resource_names.h"
#include "wire/timestamp.h"

namespace curvereg::server {
namespace {

constexpr char kDatabaseName[] = "/traverses.sqlite";

using EnginePointer = std::shared_ptr<TraverseEngine>;

class TraversesImpl final : public Traverses {
 public:
  TraversesImpl(const TraverseEnvironment& environment, std::unique_ptr<TraverseStore> store);
  ~TraversesImpl() override { Close(); }
  absl::Status Load();
  void Close() override;

  absl::StatusOr<v1::Traverse> Create(const v1::CreateTraverseRequest& request) override;
  absl::StatusOr<std::shared_ptr<TrackedTraverse>> Find(const std::string& name) override { return FindEngine(name); }
  absl::StatusOr<v1::ListTraversesResponse> List(const v1::ListTraversesRequest& request) override;
  absl::Status Delete(const std::string& name) override;
  absl::Status DeleteScan(const std::string& scan_id) override { return uses_.DeleteScan(scan_id); }
  uint64_t num_traverses() override;

 private:
  absl::StatusOr<EnginePointer> FindEngine(const std::string& name);
  std::map<std::string, EnginePointer> Engines();
  absl::StatusOr<v1::Traverse> AddTraverse(const v1::CreateTraverseRequest& request, const std::string& name);
  absl::Status RemoveTraverse(const std::string& name);
  void ForgetPartialUploads(const TraverseRecord& record);

  const std::unique_ptr<Logger> silent_ = Logger::Silent();
  const std::unique_ptr<TraverseStore> store_;
  ScanUses uses_;
  DelayedCalls delayed_;
  const TrackingEnvironment environment_;
  std::mutex lifecycle_mutex_;                    // held while a traverse is made or removed; taken first
  std::mutex mutex_;                              // guards engines_; nothing else is taken while it is held
  std::map<std::string, EnginePointer> engines_;  // by name
};

TraversesImpl::TraversesImpl(const TraverseEnvironment& environment, std::unique_ptr<TraverseStore> store)
    : store_(std::move(store)),
      uses_(store_.get(), environment.scans.store, environment.scans.cache),
      environment_{.scans = environment.scans,
                   .store = store_.get(),
                   .uses = &uses_,
                   .pool = environment.pool,
                   .delayed = &delayed_,
                   .logger = environment.logger != nullptr ? environment.logger : silent_.get()} {}

void TraversesImpl::Close() {
  const std::lock_guard lifecycle(lifecycle_mutex_);
  for (const auto& [name, engine] : Engines()) engine->Close();
}

std::map<std::string, EnginePointer> TraversesImpl::Engines() {
  const std::lock_guard lock(mutex_);
  return engines_;
}

absl::Status TraversesImpl::Load() {
  const absl::StatusOr<std::vector<TraverseRecord>> records = store_->Traverses();
  if (!records.ok()) return records.status();
  int64_t num_waiting = 0;
  for (const TraverseRecord& record : *records) {
    absl::StatusOr<EnginePointer> engine =
        TraverseEngine::Open(environment_, record, std::make_shared<TraverseWatchers>());
    if (!engine.ok()) return engine.status();
    engines_.emplace(record.traverse.name(), *std::move(engine));
    num_waiting +=
        static_cast<int64_t>(record.traverse.next_sequence_number() - record.traverse.registered_scan_count());
  }
  environment_.logger->Info("traverses_opened",
                            {{"traverses", static_cast<int64_t>(engines_.size())}, {"waiting_scans", num_waiting}});
  uses_.DeletePending();
  for (const auto& [name, engine] : engines_) engine->Start();
  return absl::OkStatus();
}

absl::StatusOr<EnginePointer> TraversesImpl::FindEngine(const std::string& name) {
  const absl::StatusOr<std::string> id = wire::TraverseIdOf(name, "name");
  if (!id.ok()) return id.status();
  const std::lock_guard lock(mutex_);
  const auto found = engines_.find(name);
  if (found == engines_.end()) return TraverseNotFound(name);
  return found->second;
}

absl::StatusOr<v1::Traverse> TraversesImpl::Create(const v1::CreateTraverseRequest& request) {
  const std::string name = wire::TraverseName(request.traverse_id());
  if (!wire::TraverseIdOf(name, "").ok()) return wire::FieldError("traverse_id", "must be 1 to 64 of a-z, 0-9 and '-'");
  const absl::Status valid =
      FromWire(request.settings(), environment_.scans.limits.max_threads_per_registration).status();
  if (!valid.ok()) return wire::WithinField("settings", valid);
  const std::lock_guard lifecycle(lifecycle_mutex_);
  const absl::StatusOr<EnginePointer> known = FindEngine(name);
  if (!known.ok()) return AddTraverse(request, name);
  const v1::Traverse traverse = (*known)->record().traverse;
  if (google::protobuf::util::MessageDifferencer::Equivalent(traverse.settings(), request.settings())) return traverse;
  return wire::MakeError(v1::ERROR_REASON_TRAVERSE_EXISTS, absl::StrCat(name, " exists with other settings"));
}

absl::StatusOr<v1::Traverse> TraversesImpl::AddTraverse(const v1::CreateTraverseRequest& request,
                                                        const std::string& name) {
  if (num_traverses() >= static_cast<uint64_t>(environment_.scans.limits.max_traverses)) {
    return wire::MakeError(v1::ERROR_REASON_TOO_MANY_TRAVERSES, "the server keeps as many traverses as it may",
                           {{"limit", absl::StrCat(environment_.scans.limits.max_traverses)}});
  }
  TraverseRecord record;
  record.traverse.set_name(name);
  *record.traverse.mutable_settings() = request.settings();
  *record.traverse.mutable_create_time() = wire::TimestampOf(std::chrono::system_clock::now());
  if (absl::Status status = store_->AddTraverse(record); !status.ok()) return status;
  absl::StatusOr<EnginePointer> engine =
      TraverseEngine::Open(environment_, record, std::make_shared<TraverseWatchers>());
  if (!engine.ok()) return engine.status();
  const std::lock_guard lock(mutex_);
  engines_.emplace(name, *std::move(engine));
  return record.traverse;
}

absl::StatusOr<v1::ListTraversesResponse> TraversesImpl::List(const v1::ListTraversesRequest& request) {
  const absl::StatusOr<int> page_size = PageSize(request.page_size());
  if (!page_size.ok()) return page_size.status();
  const absl::StatusOr<int64_t> before = PlaceOf(request.page_token(), std::numeric_limits<int64_t>::max());
  if (!before.ok()) return before.status();
  std::map<int64_t, v1::Traverse, std::greater<>> newest_first;
  for (const auto& [name, engine] : Engines()) {
    TraverseRecord record = engine->record();
    if (record.number < *before) newest_first.emplace(record.number, std::move(record.traverse));
  }
  v1::ListTraversesResponse response;
  int64_t last = 0;
  for (auto& [number, traverse] : newest_first) {
    if (response.traverses_size() == *page_size) {
      response.set_next_page_token(TokenOfPlace(last));
      break;
    }
    *response.add_traverses() = std::move(traverse);
    last = number;
  }
  return response;
}

absl::Status TraversesImpl::Delete(const std::string& name) {
  if (absl::Status status = RemoveTraverse(name); !status.ok()) return status;
  environment_.logger->Info("traverse_deleted", {{"traverse", name}});
  // Takes a while, during which other traverses can be made and removed.
  uses_.DeletePending();
  return absl::OkStatus();
}

absl::Status TraversesImpl::RemoveTraverse(const std::string& name) {
  const std::lock_guard lifecycle(lifecycle_mutex_);
  const absl::StatusOr<EnginePointer> engine = FindEngine(name);
  if (!engine.ok()) return engine.status();
  const std::shared_ptr<TraverseWatchers> watchers = (*engine)->watchers();
  (*engine)->Close();
  const TraverseRecord record = (*engine)->record();
  const absl::Status status =
      environment_.scans.store->WithReservedSpace([&] { return store_->RemoveTraverse(record.number); });
  if (!status.ok()) {
    // It is still there: watchers continue, a stream has to begin again.
    (*engine)->EndStream();
    if (absl::StatusOr<EnginePointer> again = TraverseEngine::Open(environment_, record, watchers); again.ok()) {
      const std::lock_guard lock(mutex_);
      engines_[name] = *std::move(again);
    }
    watchers->Wake();
    return status;
  }
  ForgetPartialUploads(record);
  {
    const std::lock_guard lock(mutex_);
    engines_.erase(name);
  }
  watchers->Wake();  // streams, too, find that it is gone
  return absl::OkStatus();
}

// A traverse of the same name must not resume them. Those that remain, because of a fault of the disk, expire.
void TraversesImpl::ForgetPartialUploads(const TraverseRecord& record) {
  const absl::StatusOr<std::string> id = wire::TraverseIdOf(record.traverse.name(), "name");
  if (!id.ok()) return;
  const uint64_t next = record.traverse.next_sequence_number();
  for (uint64_t number = next; number <= next + record.traverse.settings().reorder_window(); ++number) {
    ForgetStreamedUpload(*id, number, *environment_.scans.store).IgnoreError();
  }
}

uint64_t TraversesImpl::num_traverses() {
  const std::lock_guard lock(mutex_);
  return engines_.size();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Traverses>> Traverses::Open(const std::string& data_dir,
                                                           const TraverseEnvironment& environment) {
  absl::StatusOr<std::unique_ptr<TraverseStore>> store = absl::UnknownError("not opened");
  // The database is made before the first scan can come.
  const StoreStatistics scans = environment.scans.store->Statistics();
  const bool may_be_new = scans.num_scans == 0 && scans.num_uploads == 0;
  // A full disk must not keep anybody from deleting.
  const absl::Status opened = environment.scans.store->WithReservedSpace([&] {
    store = TraverseStore::Open(data_dir + kDatabaseName, may_be_new);
    return store.status();
  });
  if (!opened.ok()) return opened;
  auto traverses = std::make_unique<TraversesImpl>(environment, *std::move(store));
  if (absl::Status status = traverses->Load(); !status.ok()) return status;
  return traverses;
}

}  // namespace curvereg::server
