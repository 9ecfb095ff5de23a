// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/store/small_disk.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using testing::HasCode;
using ::testing::IsEmpty;
using testing::IsOk;

class TraverseStoreTest : public ::testing::Test {
 protected:
  TraverseStoreTest() { Reopen(); }
  void Reopen() {
    store_.reset();
    auto store = TraverseStore::Open(folder_.File("traverses.sqlite"), true);
    ASSERT_THAT(store, IsOk());
    store_ = *std::move(store);
  }
  TraverseRecord Add(const std::string& name) {
    TraverseRecord record;
    record.traverse.set_name(name);
    record.traverse.mutable_settings()->set_reorder_window(3);
    EXPECT_THAT(store_->AddTraverse(record), IsOk());
    return record;
  }
  static AcknowledgedScan ScanOf(uint64_t sequence_number, const std::string& scan_id) {
    AcknowledgedScan scan;
    scan.header.set_sequence_number(sequence_number);
    scan.scan_id = scan_id;
    scan.time_ns = 5;
    return scan;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<TraverseStore> store_;
};

// A step of so many scans, as large as those of a drive are.
TraverseStep LargeStep(uint64_t num_scans) {
  TraverseStep step;
  for (uint64_t i = 0; i < num_scans; ++i) {
    v1::WatchTraverseResponse& event = step.events.emplace_back();
    event.set_event(i);
    event.mutable_result()->set_sequence_number(i);
    event.mutable_result()->mutable_result()->set_build_id(std::string(6000, 'e'));
    for (uint64_t k = 0; k < 4; ++k) {
      StoredLink link{i, k, LinkKind::kNeighbour, {}};
      link.result.set_build_id(std::string(1500, 'l'));
      step.links.push_back(link);
    }
  }
  return step;
}

TEST_F(TraverseStoreTest, RemovesALongTraverseFromAFullDisk) {
  testing::SmallDisk disk("96m");
  if (const std::string problem = disk.Mount(); !problem.empty()) GTEST_SKIP() << problem;
  const std::unique_ptr<ScanStore> scans = OpenStore(disk.File("data"));
  const std::string path = disk.File("data/traverses.sqlite");
  auto store = TraverseStore::Open(path, true);
  ASSERT_THAT(store, IsOk());
  TraverseRecord record;
  record.traverse.set_name("traverses/long");
  ASSERT_THAT((*store)->AddTraverse(record), IsOk());
  const TraverseStep step = LargeStep(1500);
  record.num_links = step.links.size();
  record.num_events = step.events.size();
  ASSERT_THAT((*store)->AddStep(record, step), IsOk());
  store->reset();  // the log is gone
  store = TraverseStore::Open(path, true);
  ASSERT_THAT(store, IsOk());
  disk.FillUp(0);
  ASSERT_THAT((*store)->RemoveTraverse(record.number), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_THAT(scans->WithReservedSpace([&] { return (*store)->RemoveTraverse(record.number); }), IsOk());
  const auto links = (*store)->Links(record.number);
  ASSERT_THAT(links, IsOk());
  EXPECT_THAT(*links, IsEmpty());
}

// One scan with its pose, link, and two events, one of them a result.
TraverseStep StepOf(uint64_t sequence_number, uint64_t first_event) {
  TraverseStep step;
  step.poses.emplace_back().set_sequence_number(sequence_number);
  step.poses.back().mutable_t_segment_sensor()->mutable_translation()->set_x(0.1);
  StoredLink link{sequence_number, sequence_number - 1, LinkKind::kNeighbour, {}};
  link.result.set_seed(7);
  step.links.push_back(link);
  step.events.emplace_back().set_event(first_event);
  step.events.back().mutable_result()->set_sequence_number(sequence_number);
  step.events.emplace_back().set_event(first_event + 1);
  step.events.back().mutable_revision()->set_version(2);
  return step;
}

TEST_F(TraverseStoreTest, GivesBackWhatItWasGiven) {
  Add("traverses/other");
  TraverseRecord record = Add("traverses/drive");
  record.traverse.set_next_sequence_number(1);
  ASSERT_THAT(store_->AddScan(record, ScanOf(0, "a")), IsOk());
  record.traverse.set_registered_scan_count(1);
  record.num_links = 1;
  record.num_events = 2;
  record.num_segments_begun = 3;
  record.num_linked_scans = 4;
  record.num_revised_links = 5;
  record.num_revised_scans = 6;
  ASSERT_THAT(store_->AddStep(record, StepOf(1, 0)), IsOk());
  ASSERT_THAT(store_->Fence(record), IsOk());
  Reopen();
  const auto records = store_->Traverses();
  ASSERT_THAT(records, IsOk());
  ASSERT_EQ(records->size(), 2U);
  const TraverseRecord& read = records->back();
  EXPECT_EQ(read.traverse.SerializeAsString(), record.traverse.SerializeAsString());
  EXPECT_EQ(read.number, record.number);
  EXPECT_EQ(read.fencing_number, record.fencing_number);
  EXPECT_THAT((std::vector<uint64_t>{read.num_events, read.num_links, read.num_linked_scans, read.num_revised_links,
                                     read.num_revised_scans}),
              ElementsAre(2, 1, 4, 5, 6));
  EXPECT_EQ(read.num_segments_begun, 3);
  const auto scans = store_->Scans(record.number, 0, TraverseStore::kAll);
  ASSERT_THAT(scans, IsOk());
  ASSERT_EQ(scans->size(), 1U);
  EXPECT_EQ(scans->front().scan_id, "a");
  EXPECT_EQ(scans->front().time_ns, 5);
  const TraverseStep step = StepOf(1, 0);
  const auto poses = store_->Poses(record.number, 0, TraverseStore::kAll);
  ASSERT_THAT(poses, IsOk());
  EXPECT_EQ(poses->traverse.SerializeAsString(), record.traverse.SerializeAsString());
  ASSERT_EQ(poses->poses.size(), 1U);
  EXPECT_EQ(poses->poses[0].SerializeAsString(), step.poses[0].SerializeAsString());
  const auto links = store_->Links(record.number);
  ASSERT_THAT(links, IsOk());
  ASSERT_EQ(links->size(), 1U);
  EXPECT_EQ(links->front().kind, LinkKind::kNeighbour);
  EXPECT_EQ(links->front().result.seed(), 7U);
  const auto events = store_->Events(record.number, 1, 10);
  ASSERT_THAT(events, IsOk());
  ASSERT_EQ(events->size(), 1U);
  EXPECT_EQ(events->front().revision().version(), 2U);
  const auto results = store_->Results(record.number, 0, 10);
  ASSERT_THAT(results, IsOk());
  ASSERT_EQ(results->size(), 1U);
  EXPECT_EQ(results->front().sequence_number(), 1U);
}

TEST_F(TraverseStoreTest, APoseReplacesTheOneBefore) {
  TraverseRecord record = Add("traverses/drive");
  record.num_links = 1;
  ASSERT_THAT(store_->AddStep(record, StepOf(1, 0)), IsOk());
  TraverseStep revision;
  revision.poses.emplace_back().set_sequence_number(1);
  revision.poses.back().set_segment(9);
  ASSERT_THAT(store_->AddStep(record, revision), IsOk());
  const auto poses = store_->Poses(record.number, 0, TraverseStore::kAll);
  ASSERT_THAT(poses, IsOk());
  ASSERT_EQ(poses->poses.size(), 1U);
  EXPECT_EQ(poses->poses[0].segment(), 9U);
}

// Two results of one scan must never be told: the database itself refuses the second, and nothing of that step is kept.
TEST_F(TraverseStoreTest, AStepIsKeptAsAWholeOrNotAtAll) {
  TraverseRecord record = Add("traverses/drive");
  record.num_links = 1;
  record.num_events = 2;
  ASSERT_THAT(store_->AddStep(record, StepOf(1, 0)), IsOk());
  record.num_links = 2;
  record.num_events = 4;
  EXPECT_THAT(store_->AddStep(record, StepOf(1, 2)), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
  EXPECT_EQ(store_->Links(record.number)->size(), 1U);
  EXPECT_EQ(store_->Events(record.number, 0, 10)->size(), 2U);
  EXPECT_EQ(store_->Traverses()->front().num_events, 2U);
}

TEST_F(TraverseStoreTest, FencingNumbersGrowAcrossTraverses) {
  TraverseRecord a = Add("traverses/a");
  TraverseRecord b = Add("traverses/b");
  uint64_t last = 0;
  for (TraverseRecord* record : {&a, &b, &a, &a, &b}) {
    ASSERT_THAT(store_->Fence(*record), IsOk());
    EXPECT_GT(record->fencing_number, last);
    last = record->fencing_number;
  }
  ASSERT_THAT(store_->RemoveTraverse(b.number), IsOk());
  TraverseRecord again = Add("traverses/b");
  EXPECT_GT(again.number, b.number);
  ASSERT_THAT(store_->Fence(again), IsOk());
  EXPECT_GT(again.fencing_number, last);
}

TEST_F(TraverseStoreTest, RemovalLeavesTheScansThatNothingElseUsesToBeDeleted) {
  const TraverseRecord a = Add("traverses/a");
  const TraverseRecord b = Add("traverses/b");
  ASSERT_THAT(store_->AddScan(a, ScanOf(0, "own")), IsOk());
  ASSERT_THAT(store_->AddScan(a, ScanOf(1, "own")), IsOk());
  ASSERT_THAT(store_->AddScan(a, ScanOf(2, "shared")), IsOk());
  ASSERT_THAT(store_->AddScan(b, ScanOf(0, "shared")), IsOk());
  EXPECT_TRUE(*store_->IsScanUsed("own"));
  ASSERT_THAT(store_->RemoveTraverse(a.number), IsOk());
  Reopen();
  EXPECT_FALSE(*store_->IsScanUsed("own"));
  EXPECT_TRUE(*store_->IsScanUsed("shared"));
  EXPECT_THAT(*store_->PendingDeletions(), ElementsAre("own"));
  // Used again before it is gone.
  ASSERT_THAT(store_->AddScan(b, ScanOf(1, "own")), IsOk());
  EXPECT_THAT(*store_->PendingDeletions(), IsEmpty());
  EXPECT_EQ(store_->Traverses()->size(), 1U);
  EXPECT_THAT(*store_->Events(a.number, 0, 10), IsEmpty());
}

TEST_F(TraverseStoreTest, TheSameNameTwiceIsRefused) {
  Add("traverses/a");
  TraverseRecord again;
  again.traverse.set_name("traverses/a");
  EXPECT_THAT(store_->AddTraverse(again), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
}

TEST(TraverseStoreFileTest, ADamagedFileIsNamed) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("traverses.sqlite");
  std::ofstream(path) << std::string(8192, 'x');
  const auto store = TraverseStore::Open(path, true);
  EXPECT_THAT(store, HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(std::string(store.status().message()), ::testing::HasSubstr(path));
}

TEST(TraverseStoreFileTest, AMissingFileIsNoNewOneInAFolderThatWasInUse) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("traverses.sqlite");
  for (int i = 0; i < 2; ++i) {  // the second time it is there, and empty
    const auto store = TraverseStore::Open(path, false);
    EXPECT_THAT(store, HasCode(absl::StatusCode::kDataLoss));
    EXPECT_THAT(std::string(store.status().message()), ::testing::HasSubstr(path));
  }
  EXPECT_THAT(TraverseStore::Open(path, true), IsOk());
  EXPECT_THAT(TraverseStore::Open(path, false), IsOk());
}

}  // namespace
}  // namespace curvereg::server
