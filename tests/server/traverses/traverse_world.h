// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses over a real store in a temporary folder, and small scans of a drive for them.
#ifndef CURVEREG_TESTS_SERVER_TRAVERSES_TRAVERSE_WORLD_H_
#define CURVEREG_TESTS_SERVER_TRAVERSES_TRAVERSE_WORLD_H_

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/traverses/traverses.h"
#include "tests/server/store/store_testing.h"
#include "tests/server/tracking/drive_scans.h"
#include "tests/testing/test_data.h"
#include "wire/point_codec.h"

namespace curvereg::server {

class TraverseWorld {
 public:
  // `data_dir`: empty: a temporary folder.
  explicit TraverseWorld(const LimitsConfig& limits = {.max_threads_per_registration = 2},
                         const std::string& data_dir = "")
      : limits_(limits), data_dir_(data_dir.empty() ? folder_.path() : data_dir), store_(OpenStore(data_dir_)) {
    Reopen();
  }

  // As a server that died and was started again: nothing is left but the folder.
  void Reopen(int num_workers = 2) {
    Close();
    pool_ = std::make_unique<WorkerPool>(WorkerPoolOptions{
        .num_workers = num_workers, .max_queue_length = max_queue_length, .max_queue_per_client = 16});
    cache_ = std::make_unique<PreparedScanCache>(uint64_t{256} << 20);
    auto traverses = Traverses::Open(data_dir_, {.scans = {.limits = limits_,
                                                           .memory = &memory_,
                                                           .cache = cache_.get(),
                                                           .store = store_.get(),
                                                           .metrics = &metrics_},
                                                 .pool = pool_.get()});
    ASSERT_THAT(traverses, testing::IsOk());
    traverses_ = *std::move(traverses);
  }
  void Close() {
    traverses_.reset();
    pool_.reset();
  }

  Traverses& operator*() { return *traverses_; }
  Traverses* operator->() { return traverses_.get(); }
  ScanStore& store() { return *store_; }
  WorkerPool& pool() { return *pool_; }
  Metrics& metrics() { return metrics_; }

  // "traverses/ID" of a new traverse.
  std::string Create(const std::string& id, const v1::TraverseSettings& settings = {}) {
    v1::CreateTraverseRequest request;
    request.set_traverse_id(id);
    *request.mutable_settings() = settings;
    const auto traverse = traverses_->Create(request);
    EXPECT_THAT(traverse, testing::IsOk());
    return traverse.ok() ? traverse->name() : "";
  }

  // One that must be there.
  std::shared_ptr<TrackedTraverse> Find(const std::string& name) {
    const auto traverse = traverses_->Find(name);
    EXPECT_THAT(traverse, testing::IsOk());
    return traverse.value_or(nullptr);
  }
  v1::Traverse Get(const std::string& name) { return Find(name)->Description(); }
  std::shared_ptr<TrackedTraverse> Find(const StreamTicket& ticket) { return Find("traverses/" + ticket.traverse_id); }

  StreamTicket Begin(const std::string& name) {
    const auto ticket = Find(name)->BeginStream(std::stop_source(std::nostopstate));
    EXPECT_THAT(ticket, testing::IsOk());
    return ticket.value_or(StreamTicket());
  }

  // Into the store of scans; its id.
  std::string Keep(const v1::PointCloud& cloud) {
    const auto stored =
        Store(*store_, {"upload", cloud.header(), cloud.data().size(), DigestOf(cloud.data())}, cloud.data());
    EXPECT_THAT(stored, testing::IsOk());
    return stored.ok() ? stored->scan.id : "";
  }

  absl::StatusOr<uint64_t> Add(const StreamTicket& ticket, uint64_t sequence_number, const v1::PointCloud& cloud) {
    return Find(ticket)->AddScan(ticket, StreamedHeader(sequence_number, cloud), Keep(cloud));
  }
  // Scans [first, end) of the drive.
  void AddDrive(const StreamTicket& ticket, int first, int end, uint64_t drive = 0) {
    for (int i = first; i < end; ++i) {
      EXPECT_THAT(Add(ticket, static_cast<uint64_t>(i), DriveCloud(i, drive)), testing::IsOk());
    }
  }

  bool WaitForScans(const std::string& name, uint64_t num_scans) {
    return BecomesTrue([&] { return Get(name).registered_scan_count() >= num_scans; });
  }

  std::vector<v1::TrajectoryPose> Poses(const std::string& name) {
    const auto response = Find(name)->Trajectory(0, "");
    EXPECT_THAT(response, testing::IsOk());
    if (!response.ok()) return {};
    return {response->poses().begin(), response->poses().end()};
  }
  // Their bytes, without time.
  std::string PoseBytes(const std::string& name) {
    std::string bytes;
    for (const v1::TrajectoryPose& pose : Poses(name)) bytes += pose.SerializeAsString();
    return bytes;
  }

  int max_queue_length = 64;  // from the next Reopen on

 private:
  LimitsConfig limits_;
  testing::TemporaryFolder folder_;
  const std::string data_dir_;
  std::unique_ptr<ScanStore> store_;
  MemoryBudget memory_{uint64_t{2} << 30};
  Metrics metrics_;
  std::unique_ptr<PreparedScanCache> cache_;
  std::unique_ptr<WorkerPool> pool_;
  std::unique_ptr<Traverses> traverses_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_TESTS_SERVER_TRAVERSES_TRAVERSE_WORLD_H_
