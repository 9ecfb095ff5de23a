// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "tests/server/tracking/tracking_world.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::IsNear;
using testing::IsOk;

class TraverseEngineTest : public ::testing::Test {
 protected:
  TraverseEngineTest() { Open(record_); }
  ~TraverseEngineTest() override { engine_->Close(); }

  void Open(const TraverseRecord& record) {
    auto engine = TraverseEngine::Open(world_.environment, record, std::make_shared<TraverseWatchers>());
    ASSERT_THAT(engine, IsOk());
    engine_ = *std::move(engine);
  }
  StreamTicket Begin() {
    const auto ticket = engine_->BeginStream(std::stop_source(std::nostopstate));
    EXPECT_THAT(ticket, IsOk());
    return ticket.value_or(StreamTicket());
  }
  absl::StatusOr<uint64_t> Add(const StreamTicket& ticket, int number) {
    const v1::PointCloud cloud = DriveCloud(number);
    scans_.push_back(world_.Keep(cloud));
    return engine_->AddScan(ticket, StreamedHeader(static_cast<uint64_t>(number), cloud), scans_.back());
  }
  void AddDrive(int num_scans) {
    const StreamTicket ticket = Begin();
    for (int i = 0; i < num_scans; ++i) ASSERT_THAT(Add(ticket, i), IsOk());
    ASSERT_TRUE(BecomesTrue(
        [&] { return engine_->Description().registered_scan_count() == static_cast<uint64_t>(num_scans); }));
  }

  TrackingWorld world_;
  const TraverseRecord record_ = world_.AddTraverse("drive");
  std::shared_ptr<TraverseEngine> engine_;
  std::vector<std::string> scans_;  // ids
};

TEST_F(TraverseEngineTest, AScanThatIsAddedIsTracked) {
  std::atomic<int> num_wakes = 0;
  const auto subscription = engine_->Subscribe([&] { ++num_wakes; });
  AddDrive(2);
  EXPECT_TRUE(BecomesTrue([&] { return num_wakes >= 2; }));
  const auto results = engine_->Results(0, 10);
  ASSERT_THAT(results, IsOk());
  ASSERT_EQ(results->size(), 2U);
  EXPECT_EQ((*results)[1].sequence_number(), 1U);
  EXPECT_EQ(engine_->Results(1, 10)->size(), 1U);
  EXPECT_EQ(engine_->Results(0, 1)->size(), 1U);
  EXPECT_THAT(*engine_->Results(2, 10), IsEmpty());
  EXPECT_EQ(engine_->Description().name(), "traverses/drive");
  EXPECT_EQ(engine_->Description().next_sequence_number(), 2U);
}

TEST_F(TraverseEngineTest, EventsBeyondTheNextAreOutOfRange) {
  EXPECT_THAT(*engine_->Events(0, 10), IsEmpty());
  const auto beyond = engine_->Events(1, 10);
  EXPECT_THAT(beyond, HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
  EXPECT_EQ(wire::ErrorInfoOf(beyond.status())->metadata().at("next_event"), "0");
}

TEST_F(TraverseEngineTest, TheTrajectoryComesInPages) {
  AddDrive(3);
  const auto first = engine_->Trajectory(2, "");
  ASSERT_THAT(first, IsOk());
  EXPECT_EQ(first->poses_size(), 2);
  const auto last = engine_->Trajectory(2, first->next_page_token());
  ASSERT_THAT(last, IsOk());
  ASSERT_EQ(last->poses_size(), 1);
  EXPECT_EQ(last->poses(0).sequence_number(), 2U);
  EXPECT_EQ(last->next_page_token(), "");
  EXPECT_THAT(engine_->Trajectory(-1, ""), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_THAT(engine_->Trajectory(2, "x"), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST_F(TraverseEngineTest, ASegmentHasItsScansAndTheirPoses) {
  AddDrive(2);
  const auto segment = engine_->ScansOfSegment(0);
  ASSERT_THAT(segment, IsOk());
  EXPECT_THAT(segment->scan_ids, ElementsAre(scans_[0], scans_[1]));
  ASSERT_EQ(segment->T_segment_scan.size(), 2U);
  EXPECT_THAT(segment->T_segment_scan[1], IsNear(DrivePose(0).inverse() * DrivePose(1), 0.03, 0.01));
  EXPECT_EQ(segment->version, engine_->Description().trajectory_version());
  EXPECT_THAT(engine_->ScansOfSegment(1), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST_F(TraverseEngineTest, AClosedOneCanBeReadAndNotChanged) {
  AddDrive(1);
  const StreamTicket ticket = Begin();
  engine_->Close();
  EXPECT_THAT(engine_->BeginStream(std::stop_source()), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(Add(ticket, 1), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  absl::Status end;
  engine_->Optimize({}, "client", {}, [&](const auto& answer) { end = answer.status(); });
  EXPECT_THAT(end, HasReason(v1::ERROR_REASON_CANCELLED));
  EXPECT_EQ(engine_->Events(0, 10)->size(), 1U);
  EXPECT_EQ(engine_->Trajectory(0, "")->poses_size(), 1);
}

// As a server that is started again: what was acknowledged is tracked, and nothing twice.
TEST_F(TraverseEngineTest, StartDoesWhatAnEarlierProcessLeft) {
  AddDrive(1);
  engine_->Close();
  TraverseJournal journal(engine_->record());
  world_.Acknowledge(journal, DriveCloud(1));
  Open(journal.record());
  EXPECT_EQ(engine_->Description().registered_scan_count(), 1U);
  engine_->Start();
  EXPECT_TRUE(BecomesTrue([&] { return engine_->Description().registered_scan_count() == 2U; }));
  EXPECT_EQ(engine_->Results(0, 10)->size(), 2U);
}

TEST_F(TraverseEngineTest, SettingsThatCannotBeReadAreRefused) {
  TraverseRecord record = record_;
  record.traverse.mutable_settings()->set_reorder_window(65);
  EXPECT_THAT(TraverseEngine::Open(world_.environment, record, std::make_shared<TraverseWatchers>()),
              HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

}  // namespace
}  // namespace curvereg::server
