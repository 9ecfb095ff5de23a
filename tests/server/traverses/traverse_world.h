// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses over a real store in a temporary folder, and small scans of a drive for them.
#ifndef CURVEREG_TESTS_SERVER_TRAVERSES_TRAVERSE_WORLD_H_
#define CURVEREG_TESTS_SERVER_TRAVERSES_TRAVERSE_WORLD_H_

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/scan/scan.h"
#include "server/traverses/traverses.h"
#include "tests/server/store/store_testing.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"
#include "wire/point_codec.h"

namespace curvereg::server {

// Where the rover of a drive stands for its scan `number`: 0.8 m apart on a bend.
inline RigidTransform DrivePose(int number) {
  return testing::RoverPose(0.8 * number, 0.02 * number * number, 0.05 * number);
}

// Encoded; `drive` tells drives over the same ground apart by their noise.
inline v1::PointCloud DriveCloud(int number, uint64_t drive = 0) {
  const Scan scan =
      testing::BumpyGround(DrivePose(number), {.num_columns = 360,
                                               .num_rows = 40,
                                               .max_range_m = 20.0,
                                               .noise_seed = 1000 * drive + static_cast<uint64_t>(number)});
  return *wire::EncodeScan(scan);
}

inline v1::StreamedScanHeader StreamedHeader(uint64_t sequence_number, const v1::PointCloud& cloud) {
  v1::StreamedScanHeader header;
  header.set_sequence_number(sequence_number);
  *header.mutable_header() = cloud.header();
  header.set_payload_bytes(cloud.data().size());
  *header.mutable_payload_digest() = DigestOf(cloud.data());
  return header;
}

// Asks every few milliseconds; false after a minute.
inline bool BecomesTrue(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

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
    auto traverses = Traverses::Open(data_dir_, {.limits = limits_,
                                                 .store = store_.get(),
                                                 .memory = &memory_,
                                                 .cache = cache_.get(),
                                                 .pool = pool_.get(),
                                                 .disk_pool = pool_.get(),
                                                 .metrics = &metrics_});
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

  StreamTicket Begin(const std::string& name) {
    const auto ticket = traverses_->BeginStream(name, std::stop_source(std::nostopstate));
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
    return traverses_->AddScan(ticket, StreamedHeader(sequence_number, cloud), Keep(cloud));
  }
  // Scans [first, end) of the drive.
  void AddDrive(const StreamTicket& ticket, int first, int end, uint64_t drive = 0) {
    for (int i = first; i < end; ++i) {
      EXPECT_THAT(Add(ticket, static_cast<uint64_t>(i), DriveCloud(i, drive)), testing::IsOk());
    }
  }

  bool WaitForScans(const std::string& name, uint64_t num_scans) {
    return BecomesTrue([&] { return traverses_->Get(name)->registered_scan_count() >= num_scans; });
  }

  std::vector<v1::TrajectoryPose> Poses(const std::string& name) {
    v1::GetTrajectoryRequest request;
    request.set_name(name);
    const auto response = traverses_->GetTrajectory(request);
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
