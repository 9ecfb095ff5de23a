// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the traverses of a server share, over real stores in a temporary folder.
#ifndef CURVEREG_TESTS_SERVER_TRACKING_TRACKING_WORLD_H_
#define CURVEREG_TESTS_SERVER_TRACKING_TRACKING_WORLD_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "server/tracking/tracking_environment.h"
#include "server/tracking/traverse_conversion.h"
#include "server/tracking/traverse_journal.h"
#include "tests/server/store/store_testing.h"
#include "tests/server/tracking/drive_scans.h"
#include "tests/testing/test_data.h"
#include "wire/resource_names.h"
#include "wire/timestamp.h"

namespace curvereg::server {

struct TrackingWorldOptions {
  LimitsConfig limits{.max_threads_per_registration = 2};
  int max_queue_length = 64;
};

class TrackingWorld {
 public:
  explicit TrackingWorld(const TrackingWorldOptions& options = {})
      : pool({.num_workers = 1, .max_queue_length = options.max_queue_length}) {
    auto traverses = TraverseStore::Open(folder_.File("traverses.sqlite"), true);
    EXPECT_THAT(traverses, testing::IsOk());
    store = *std::move(traverses);
    uses = std::make_unique<ScanUses>(store.get(), scans.get(), &cache);
    environment = {.scans = {.limits = options.limits,
                             .memory = &memory,
                             .cache = &cache,
                             .store = scans.get(),
                             .metrics = &metrics},
                   .store = store.get(),
                   .uses = uses.get(),
                   .pool = &pool,
                   .delayed = &delayed,
                   .logger = logger.get()};
  }

  // A new traverse, in the database.
  TraverseRecord AddTraverse(const std::string& id, const v1::TraverseSettings& settings = {}) {
    TraverseRecord record;
    record.traverse.set_name(wire::TraverseName(id));
    *record.traverse.mutable_settings() = settings;
    EXPECT_THAT(store->AddTraverse(record), testing::IsOk());
    return record;
  }
  TrackingOptions OptionsOf(const TraverseRecord& record) const {
    const auto options = FromWire(record.traverse.settings(), environment.scans.limits.max_threads_per_registration);
    EXPECT_THAT(options, testing::IsOk());
    return options.value_or(TrackingOptions());
  }

  // Into the store of scans; its id.
  std::string Keep(const v1::PointCloud& cloud) {
    const auto stored =
        Store(*scans, {"upload", cloud.header(), cloud.data().size(), DigestOf(cloud.data())}, cloud.data());
    EXPECT_THAT(stored, testing::IsOk());
    return stored.ok() ? stored->scan.id : "";
  }
  // The next scan of a traverse, stored and acknowledged without a stream.
  AcknowledgedScan Acknowledge(TraverseJournal& journal, const v1::PointCloud& cloud) {
    AcknowledgedScan scan;
    const absl::Status added = journal.Change(
        [&](TraverseRecord& record) {
          const uint64_t number = record.traverse.next_sequence_number();
          scan = {StreamedHeader(number, cloud), Keep(cloud), wire::NanosecondsOf(std::chrono::system_clock::now())};
          record.traverse.set_next_sequence_number(number + 1);
          return store->AddScan(record, scan);
        },
        absl::CancelledError("closed"));
    EXPECT_THAT(added, testing::IsOk());
    return scan;
  }

 private:
  testing::TemporaryFolder folder_;

 public:
  std::unique_ptr<ScanStore> scans = OpenStore(folder_.path());
  std::unique_ptr<TraverseStore> store;
  std::unique_ptr<ScanUses> uses;
  MemoryBudget memory{uint64_t{2} << 30};
  PreparedScanCache cache{uint64_t{256} << 20};
  Metrics metrics;
  std::unique_ptr<Logger> logger = Logger::Silent();
  DelayedCalls delayed;
  WorkerPool pool;
  TrackingEnvironment environment;
};

}  // namespace curvereg::server

#endif  // CURVEREG_TESTS_SERVER_TRACKING_TRACKING_WORLD_H_
