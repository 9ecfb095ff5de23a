// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverses.h"

#include <google/protobuf/util/message_differencer.h>

#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/scans/scan_conversion.h"
#include "server/scheduling/delayed_calls.h"
#include "server/store/page_token.h"
#include "server/tracking/traverse_conversion.h"
#include "server/tracking/traverse_engine.h"
#include "server/tracking/traverse_store.h"
#include "server/traverses/streamed_upload.h"
#include "wire/error.h"
#include "wire/timestamp.h"
#include "wire/trajectory_conversion.h"

namespace curvereg::server {
namespace {

constexpr char kDatabaseName[] = "/traverses.sqlite";

using EnginePointer = std::shared_ptr<TraverseEngine>;

class TraversesImpl final : public Traverses {
 public:
  TraversesImpl(const TraverseEnvironment& environment, std::unique_ptr<TraverseStore> store);
  ~TraversesImpl() override;
  absl::Status Load();
  void Close() override;

  absl::StatusOr<v1::Traverse> Create(const v1::CreateTraverseRequest& request) override;
  absl::StatusOr<v1::Traverse> Get(const std::string& name) override;
  absl::StatusOr<v1::ListTraversesResponse> List(const v1::ListTraversesRequest& request) override;
  absl::StatusOr<v1::GetTrajectoryResponse> GetTrajectory(const v1::GetTrajectoryRequest& request) override;
  absl::Status Delete(const std::string& name) override;
  absl::StatusOr<StreamTicket> BeginStream(const std::string& name, const std::stop_source& owner) override;
  absl::Status CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) override;
  absl::StatusOr<uint64_t> AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                   const std::string& scan_id) override;
  absl::StatusOr<std::vector<v1::WatchTraverseResponse>> Events(const std::string& name, uint64_t first_event,
                                                                int max_events) override;
  absl::StatusOr<std::vector<v1::ScanResult>> Results(const std::string& name, uint64_t first_sequence_number,
                                                      int max_results) override;
  absl::StatusOr<std::unique_ptr<Subscription>> Subscribe(const std::string& name, std::function<void()> wake) override;
  void Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                OptimizeDone done) override;
  absl::StatusOr<MapSource> SourceOfMap(const std::string& name, uint32_t segment) override;
  absl::Status DeleteScan(const std::string& scan_id) override;
  uint64_t num_traverses() override;

 private:
  absl::StatusOr<EnginePointer> Find(const std::string& name);
  absl::StatusOr<EnginePointer> MakeEngine(const TraverseRecord& record,
                                           std::shared_ptr<TraverseWatchers> watchers = nullptr);  // new ones
  absl::StatusOr<v1::Traverse> AddTraverse(const v1::CreateTraverseRequest& request, const std::string& name);
  absl::Status RemoveTraverse(const std::string& name);
  void ForgetPartialUploads(const TraverseRecord& record);
  void RemoveDoomedScans();
  void RemoveDoomedScan(const std::string& scan_id);

  const TraverseEnvironment environment_;
  const std::unique_ptr<Logger> silent_ = Logger::Silent();
  const std::unique_ptr<TraverseStore> store_;
  DelayedCalls delayed_;
  const TraverseEngine::Environment engine_environment_;
  std::mutex lifecycle_mutex_;  // held while a traverse is made or removed; taken first
  std::mutex uses_mutex_;       // held while a scan becomes part of a traverse, or is removed; taken second
  std::mutex mutex_;            // guards engines_; nothing else is taken while it is held
  std::map<std::string, EnginePointer> engines_;  // by name
};

TraversesImpl::TraversesImpl(const TraverseEnvironment& environment, std::unique_ptr<TraverseStore> store)
    : environment_(environment),
      store_(std::move(store)),
      engine_environment_{.work = {.scans = {.calls = {.metrics = environment.metrics, .draining = {}, .ending = {}},
                                             .limits = environment.limits,
                                             .memory = environment.memory,
                                             .cache = environment.cache,
                                             .store = environment.store},
                                   .store = store_.get(),
                                   .logger = environment.logger != nullptr ? environment.logger : silent_.get()},
                          .limits = environment.limits,
                          .pool = environment.pool,
                          .delayed = &delayed_} {}

TraversesImpl::~TraversesImpl() { Close(); }

void TraversesImpl::Close() {
  const std::lock_guard lifecycle(lifecycle_mutex_);
  std::map<std::string, EnginePointer> engines;
  {
    const std::lock_guard lock(mutex_);
    engines = engines_;
  }
  for (const auto& [name, engine] : engines) engine->Close();
}

absl::Status TraversesImpl::Load() {
  const absl::StatusOr<std::vector<TraverseRecord>> records = store_->Traverses();
  if (!records.ok()) return records.status();
  int64_t num_waiting = 0;
  for (const TraverseRecord& record : *records) {
    absl::StatusOr<EnginePointer> engine = MakeEngine(record);
    if (!engine.ok()) return engine.status();
    engines_.emplace(record.traverse.name(), *std::move(engine));
    num_waiting +=
        static_cast<int64_t>(record.traverse.next_sequence_number() - record.traverse.registered_scan_count());
  }
  Logger& logger = *engine_environment_.work.logger;
  logger.Info("traverses_opened",
              {{"traverses", static_cast<int64_t>(engines_.size())}, {"waiting_scans", num_waiting}});
  RemoveDoomedScans();
  for (const auto& [name, engine] : engines_) engine->Kick();
  return absl::OkStatus();
}

absl::StatusOr<EnginePointer> TraversesImpl::MakeEngine(const TraverseRecord& record,
                                                        std::shared_ptr<TraverseWatchers> watchers) {
  if (watchers == nullptr) watchers = std::make_shared<TraverseWatchers>();
  const absl::StatusOr<TrackingOptions> options =
      FromWire(record.traverse.settings(), environment_.limits.max_threads_per_registration);
  if (!options.ok()) return options.status();
  const absl::StatusOr<std::vector<AcknowledgedScan>> beyond =
      store_->Scans(record.number, record.traverse.next_sequence_number(), TraverseStore::kAll);
  if (!beyond.ok()) return beyond.status();
  std::set<uint64_t> early;
  for (const AcknowledgedScan& scan : *beyond) early.insert(scan.header.sequence_number());
  return std::make_shared<TraverseEngine>(engine_environment_, record, std::move(early), *options, std::move(watchers));
}

absl::StatusOr<EnginePointer> TraversesImpl::Find(const std::string& name) {
  const absl::StatusOr<std::string> id = TraverseIdOf(name, "name");
  if (!id.ok()) return id.status();
  const std::lock_guard lock(mutex_);
  const auto found = engines_.find(name);
  if (found == engines_.end()) return TraverseNotFound(name);
  return found->second;
}

absl::StatusOr<v1::Traverse> TraversesImpl::Create(const v1::CreateTraverseRequest& request) {
  const std::string name = TraverseName(request.traverse_id());
  if (!TraverseIdOf(name, "").ok()) return wire::FieldError("traverse_id", "must be 1 to 64 of a-z, 0-9 and '-'");
  const absl::Status valid = FromWire(request.settings(), environment_.limits.max_threads_per_registration).status();
  if (!valid.ok()) return wire::WithinField("settings", valid);
  const std::lock_guard lifecycle(lifecycle_mutex_);
  const absl::StatusOr<EnginePointer> known = Find(name);
  if (!known.ok()) return AddTraverse(request, name);
  const v1::Traverse traverse = (*known)->record().traverse;
  if (google::protobuf::util::MessageDifferencer::Equivalent(traverse.settings(), request.settings())) return traverse;
  return wire::MakeError(v1::ERROR_REASON_TRAVERSE_EXISTS, absl::StrCat(name, " exists with other settings"));
}

absl::StatusOr<v1::Traverse> TraversesImpl::AddTraverse(const v1::CreateTraverseRequest& request,
                                                        const std::string& name) {
  if (num_traverses() >= static_cast<uint64_t>(environment_.limits.max_traverses)) {
    return wire::MakeError(v1::ERROR_REASON_TOO_MANY_TRAVERSES, "the server keeps as many traverses as it may",
                           {{"limit", absl::StrCat(environment_.limits.max_traverses)}});
  }
  TraverseRecord record;
  record.traverse.set_name(name);
  *record.traverse.mutable_settings() = request.settings();
  *record.traverse.mutable_create_time() = wire::TimestampOf(std::chrono::system_clock::now());
  if (absl::Status status = store_->AddTraverse(record); !status.ok()) return status;
  absl::StatusOr<EnginePointer> engine = MakeEngine(record);
  if (!engine.ok()) return engine.status();
  const std::lock_guard lock(mutex_);
  engines_.emplace(name, *std::move(engine));
  return record.traverse;
}

absl::StatusOr<v1::Traverse> TraversesImpl::Get(const std::string& name) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  return (*engine)->record().traverse;
}

absl::StatusOr<v1::ListTraversesResponse> TraversesImpl::List(const v1::ListTraversesRequest& request) {
  const absl::StatusOr<int> page_size = PageSize(request.page_size());
  if (!page_size.ok()) return page_size.status();
  const absl::StatusOr<int64_t> before = PlaceOf(request.page_token(), std::numeric_limits<int64_t>::max());
  if (!before.ok()) return before.status();
  std::map<std::string, EnginePointer> engines;
  {
    const std::lock_guard lock(mutex_);
    engines = engines_;
  }
  std::map<int64_t, v1::Traverse, std::greater<>> newest_first;
  for (const auto& [name, engine] : engines) {
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

absl::StatusOr<v1::GetTrajectoryResponse> TraversesImpl::GetTrajectory(const v1::GetTrajectoryRequest& request) {
  const absl::StatusOr<EnginePointer> engine = Find(request.name());
  if (!engine.ok()) return engine.status();
  const absl::StatusOr<int> page_size = PageSize(request.page_size(), kMaxPageSize);
  if (!page_size.ok()) return page_size.status();
  const absl::StatusOr<int64_t> first = PlaceOf(request.page_token(), 0);
  if (!first.ok()) return first.status();
  absl::StatusOr<StoredPoses> stored =
      store_->Poses((*engine)->record().number, static_cast<uint64_t>(*first), *page_size + 1);
  if (!stored.ok()) return stored.status();
  v1::GetTrajectoryResponse response;
  response.set_version(stored->traverse.trajectory_version());
  for (v1::TrajectoryPose& pose : stored->poses) {
    if (response.poses_size() == *page_size) {
      response.set_next_page_token(TokenOfPlace(static_cast<int64_t>(pose.sequence_number())));
      break;
    }
    *response.add_poses() = std::move(pose);
  }
  return response;
}

absl::Status TraversesImpl::Delete(const std::string& name) {
  if (absl::Status status = RemoveTraverse(name); !status.ok()) return status;
  engine_environment_.work.logger->Info("traverse_deleted", {{"traverse", name}});
  // Takes a while, during which other traverses can be made and removed.
  RemoveDoomedScans();
  return absl::OkStatus();
}

absl::Status TraversesImpl::RemoveTraverse(const std::string& name) {
  const std::lock_guard lifecycle(lifecycle_mutex_);
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  const std::shared_ptr<TraverseWatchers> watchers = (*engine)->watchers();
  (*engine)->Close();
  const TraverseRecord record = (*engine)->record();
  const absl::Status status = environment_.store->WithReservedSpace([&] { return store_->RemoveTraverse(record.number); });
  if (!status.ok()) {
    // It is still there: who watches goes on, who streams begins anew.
    (*engine)->EndStream();
    if (absl::StatusOr<EnginePointer> again = MakeEngine(record, watchers); again.ok()) {
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

// A traverse of the same name is not to go on with them. Those that stay behind, for a fault of the disk, expire.
void TraversesImpl::ForgetPartialUploads(const TraverseRecord& record) {
  const absl::StatusOr<std::string> id = TraverseIdOf(record.traverse.name(), "name");
  if (!id.ok()) return;
  const uint64_t next = record.traverse.next_sequence_number();
  for (uint64_t number = next; number <= next + record.traverse.settings().reorder_window(); ++number) {
    ForgetStreamedUpload(*id, number, *environment_.store).IgnoreError();
  }
}

// Those that stay behind, for a fault of the disk, are removed at the next start.
void TraversesImpl::RemoveDoomedScans() {
  const absl::StatusOr<std::vector<std::string>> scans = store_->DoomedScans();
  if (!scans.ok()) return;
  for (const std::string& id : *scans) RemoveDoomedScan(id);
}

// Locks for one scan only, so that no stream waits for hundreds.
void TraversesImpl::RemoveDoomedScan(const std::string& scan_id) {
  const std::lock_guard uses(uses_mutex_);
  const absl::StatusOr<bool> is_used = store_->IsScanUsed(scan_id);
  if (!is_used.ok() || *is_used) return;  // wanted again meanwhile
  const absl::Status deleted = environment_.store->DeleteScan(scan_id);
  if (!deleted.ok() && wire::ReasonOf(deleted) != v1::ERROR_REASON_SCAN_NOT_FOUND) return;
  environment_.cache->Erase(ScanName(scan_id));
  store_->Spare(scan_id).IgnoreError();
}

absl::Status TraversesImpl::DeleteScan(const std::string& scan_id) {
  const std::lock_guard uses(uses_mutex_);
  const absl::StatusOr<bool> is_used = store_->IsScanUsed(scan_id);
  if (!is_used.ok()) return is_used.status();
  if (*is_used) return wire::MakeError(v1::ERROR_REASON_SCAN_IN_USE, "a traverse uses the scan; delete that first");
  return environment_.store->DeleteScan(scan_id);
}

absl::StatusOr<StreamTicket> TraversesImpl::BeginStream(const std::string& name, const std::stop_source& owner) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  return (*engine)->BeginStream(owner);
}

absl::Status TraversesImpl::CheckScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header, bool* known) {
  const absl::StatusOr<EnginePointer> engine = Find(TraverseName(ticket.traverse_id));
  if (!engine.ok()) return engine.status();
  return (*engine)->CheckScan(ticket, header, known);
}

absl::StatusOr<uint64_t> TraversesImpl::AddScan(const StreamTicket& ticket, const v1::StreamedScanHeader& header,
                                                const std::string& scan_id) {
  const absl::StatusOr<EnginePointer> engine = Find(TraverseName(ticket.traverse_id));
  if (!engine.ok()) return engine.status();
  const std::lock_guard uses(uses_mutex_);
  bool known = false;
  if (absl::Status status = (*engine)->CheckScan(ticket, header, &known); !status.ok()) return status;
  // One that is known may be claimed to be a scan that never was: the engine tells.
  const absl::Status stored = known ? absl::OkStatus() : environment_.store->GetScan(scan_id).status();
  return stored.ok() ? (*engine)->AddScan(ticket, header, scan_id) : stored;
}

absl::StatusOr<std::vector<v1::WatchTraverseResponse>> TraversesImpl::Events(const std::string& name,
                                                                             uint64_t first_event, int max_events) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  const TraverseRecord record = (*engine)->record();
  if (first_event > record.num_events) {
    return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "there is no event of that number yet",
                           {{"next_event", absl::StrCat(record.num_events)}});
  }
  return store_->Events(record.number, first_event, max_events);
}

absl::StatusOr<std::vector<v1::ScanResult>> TraversesImpl::Results(const std::string& name,
                                                                   uint64_t first_sequence_number, int max_results) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  const TraverseRecord record = (*engine)->record();
  if (first_sequence_number >= record.traverse.registered_scan_count()) return std::vector<v1::ScanResult>();
  return store_->Results(record.number, first_sequence_number, max_results);
}

absl::StatusOr<std::unique_ptr<Traverses::Subscription>> TraversesImpl::Subscribe(const std::string& name,
                                                                                  std::function<void()> wake) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  return (*engine)->watchers()->Add(std::move(wake));
}

void TraversesImpl::Optimize(const v1::OptimizeTraverseRequest& request, const std::string& client, const Stop& stop,
                             OptimizeDone done) {
  const absl::StatusOr<EnginePointer> engine = Find(request.name());
  if (!engine.ok()) {
    done(engine.status());
    return;
  }
  (*engine)->Optimize(request, client, stop, std::move(done));
}

absl::StatusOr<Traverses::MapSource> TraversesImpl::SourceOfMap(const std::string& name, uint32_t segment) {
  const absl::StatusOr<EnginePointer> engine = Find(name);
  if (!engine.ok()) return engine.status();
  const int64_t number = (*engine)->record().number;
  const absl::StatusOr<StoredPoses> poses = store_->Poses(number, 0, TraverseStore::kAll);
  if (!poses.ok()) return poses.status();
  const absl::StatusOr<std::vector<AcknowledgedScan>> scans =
      store_->Scans(number, 0, static_cast<int64_t>(poses->poses.size()));
  if (!scans.ok()) return scans.status();
  if (scans->size() != poses->poses.size()) return TraverseNotFound(name);  // deleted meanwhile
  MapSource source;
  source.version = poses->traverse.trajectory_version();
  for (size_t i = 0; i < scans->size(); ++i) {
    if (poses->poses[i].segment() != segment) continue;
    const absl::StatusOr<TrajectoryPose> pose = wire::FromWire(poses->poses[i]);
    if (!pose.ok()) return pose.status();
    source.scan_ids.push_back((*scans)[i].scan_id);
    source.T_segment_scan.push_back(pose->T_segment_scan);
  }
  if (source.scan_ids.empty()) return wire::FieldError("segment", "the traverse has no such segment");
  return source;
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
  const StoreStatistics scans = environment.store->Statistics();
  const bool may_be_new = scans.num_scans == 0 && scans.num_uploads == 0;
  // A full disk must not keep anybody from deleting.
  const absl::Status opened = environment.store->WithReservedSpace([&] {
    store = TraverseStore::Open(data_dir + kDatabaseName, may_be_new);
    return store.status();
  });
  if (!opened.ok()) return opened;
  auto traverses = std::make_unique<TraversesImpl>(environment, *std::move(store));
  if (absl::Status status = traverses->Load(); !status.ok()) return status;
  return traverses;
}

}  // namespace curvereg::server
