// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/called_services.h"

#include <grpcpp/server_builder.h>

#include <chrono>
#include <cstdlib>
#include <stop_token>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "fuzz/request_checks.h"
#include "wire/digest.h"
#include "wire/point_codec.h"

namespace curvereg::server {
namespace {

constexpr char kTraverseId[] = "t";
constexpr char kTraverse[] = "traverses/t";
constexpr int kNumScans = 2;

// Removed at the end of the process, unless it aborts.
std::filesystem::path NewFolder() {
  static std::string name = (std::filesystem::temp_directory_path() / "curvereg-fuzz-XXXXXX").string();
  Require(mkdtemp(name.data()) != nullptr);
  std::atexit([] {
    std::error_code ignored;
    std::filesystem::remove_all(name, ignored);
  });
  return name;
}

template <typename Value>
Value Need(absl::StatusOr<Value> value) {
  Require(value.ok());
  return *std::move(value);
}

// Of points that determine no pose: tracking it costs next to nothing.
v1::PointCloud SmallCloud(int number) {
  Scan scan;
  for (int i = 0; i < 4; ++i) scan.points.emplace_back(1.0F, 0.5F * static_cast<float>(i), static_cast<float>(number));
  return Need(wire::EncodeScan(scan));
}

v1::Digest DigestOf(const v1::PointCloud& cloud) { return wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, cloud.data()); }

}  // namespace

CalledServices::CalledServices() : folder_(NewFolder()) {
  LimitsConfig limits = FuzzLimits();
  limits.max_threads_per_registration = 1;
  store_ = Need(ScanStore::Open(folder_.string(), {}));
  const ScanSources sources = {
      .limits = limits, .memory = &memory_, .cache = &cache_, .store = store_.get(), .metrics = &metrics_};
  traverses_ = Need(Traverses::Open(folder_.string(), {.scans = sources, .pool = &pool_}));
  maps_ = Need(MapBuilder::Open(folder_.string(), {.limits = limits, .store = store_.get(), .memory = &memory_},
                                {.max_stored_bytes = uint64_t{1} << 20}));
  CallEnvironment calls;
  calls.access = access_.get();
  calls.metrics = &metrics_;
  ScanBackend scans;
  scans.calls = calls;
  scans.limits = limits;
  scans.disk_pool = &disk_pool_;
  scans.memory = &memory_;
  scans.store = store_.get();
  scans.delete_scan = [this](const std::string& scan_id) { return traverses_->DeleteScan(scan_id); };
  scan_service_ = std::make_unique<ScanService>(scans);
  traverse_service_ = std::make_unique<TraverseService>(
      TraverseBackend{calls, sources, &pool_, &disk_pool_, traverses_.get(), maps_.get()});
  grpc::ServerBuilder builder;
  builder.RegisterService(scan_service_.get());
  builder.RegisterService(traverse_service_.get());
  server_ = builder.BuildAndStart();
  Require(server_ != nullptr);
  stub_ = std::make_unique<grpc::GenericStub>(server_->InProcessChannel({}));
  MakeUpload();
  Restore();
}

std::string CalledServices::Keep(int number) {
  const v1::PointCloud cloud = SmallCloud(number);
  const UploadDescription description = {"scan", cloud.header(), cloud.data().size(), DigestOf(cloud)};
  if (const auto known = Need(store_->FindScan(description)); known.has_value()) return known->id;
  const std::unique_ptr<UploadWriter> writer = Need(store_->BeginUpload(description));
  Require(writer->Append(0, std::string_view(cloud.data())).ok());
  return Need(writer->Commit(cloud.header().point_count(), "content")).scan.id;
}

void CalledServices::MakeUpload() {
  const v1::PointCloud cloud = SmallCloud(100);
  const auto writer = Need(store_->BeginUpload({"u", cloud.header(), cloud.data().size(), DigestOf(cloud)}));
  Require(writer->Append(0, std::string_view(cloud.data()).substr(0, 12)).ok());
}

void CalledServices::MakeTraverse() {
  v1::CreateTraverseRequest request;
  request.set_traverse_id(kTraverseId);
  Need(traverses_->Create(request));
  const std::shared_ptr<TrackedTraverse> traverse = Need(traverses_->Find(kTraverse));
  const StreamTicket ticket = Need(traverse->BeginStream(std::stop_source(std::nostopstate)));
  for (int i = 0; i < kNumScans; ++i) {
    const v1::PointCloud cloud = SmallCloud(i);
    v1::StreamedScanHeader header;
    header.set_sequence_number(static_cast<uint64_t>(i));
    *header.mutable_header() = cloud.header();
    header.set_payload_bytes(cloud.data().size());
    *header.mutable_payload_digest() = DigestOf(cloud);
    Need(traverse->AddScan(ticket, header, Keep(i)));
  }
  while (traverse->Description().registered_scan_count() < uint64_t{kNumScans}) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void CalledServices::Restore() {
  Keep(kNumScans);
  bool is_there = false;
  const v1::ListTraversesResponse list = Need(traverses_->List({}));
  for (const v1::Traverse& traverse : list.traverses()) {
    is_there = is_there || traverse.name() == kTraverse;
    if (traverse.name() != kTraverse) Require(traverses_->Delete(traverse.name()).ok());
  }
  if (!is_there) MakeTraverse();
}

}  // namespace curvereg::server
