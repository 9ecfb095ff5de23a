// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "tests/server/tracking/tracking_world.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::Not;

// A logger whose lines can be read.
class WarningLog {
 public:
  WarningLog() : logger_(*Logger::Create({.format = "json", .level = "warning"}, file_)) {}
  ~WarningLog() {
    logger_.reset();
    std::fclose(file_);
  }
  Logger* logger() { return logger_.get(); }
  std::string Text() {
    std::fflush(file_);
    std::rewind(file_);
    std::string text;
    std::array<char, 4096> piece{};
    while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), file_)) text.append(piece.data(), size);
    return text;
  }

 private:
  std::FILE* const file_ = std::tmpfile();
  std::unique_ptr<Logger> logger_;
};

class TraverseTasksTest : public ::testing::Test {
 protected:
  TraverseTasksTest() {
    world_.environment.logger = log_.logger();
    const TraverseRecord record = world_.AddTraverse("drive");
    journal_ = std::make_shared<TraverseJournal>(record);
    tasks_ = std::make_unique<TraverseTasks>(world_.environment, world_.OptionsOf(record), journal_, watchers_);
  }
  void Track(const v1::PointCloud& cloud) {
    world_.Acknowledge(*journal_, cloud);
    ASSERT_THAT(tasks_->Track(false, {}), IsOk());
  }
  std::vector<v1::WatchTraverseResponse> Events() {
    const auto events = world_.store->Events(journal_->record().number, 0, 1000);
    EXPECT_THAT(events, IsOk());
    return events.value_or(std::vector<v1::WatchTraverseResponse>());
  }

  WarningLog log_;
  TrackingWorld world_;
  std::shared_ptr<TraverseWatchers> watchers_ = std::make_shared<TraverseWatchers>();
  std::shared_ptr<TraverseJournal> journal_;
  std::unique_ptr<TraverseTasks> tasks_;
};

TEST_F(TraverseTasksTest, ATrackedScanIsOnDiskAndAnEvent) {
  int num_wakes = 0;
  const auto subscription = watchers_->Add([&] { ++num_wakes; });
  Track(DriveCloud(0));
  Track(DriveCloud(1));
  EXPECT_EQ(num_wakes, 2);
  EXPECT_EQ(journal_->record().traverse.registered_scan_count(), 2U);
  const auto events = Events();
  ASSERT_EQ(events.size(), 2U);
  for (uint64_t i = 0; i < 2; ++i) {
    EXPECT_EQ(events[i].event(), i);
    EXPECT_TRUE(events[i].has_time());
    EXPECT_EQ(events[i].result().sequence_number(), i);
  }
  EXPECT_EQ(world_.memory.reserved_bytes(), 0U);
}

TEST_F(TraverseTasksTest, ASegmentThatBeginsIsAWarning) {
  Track(DriveCloud(0));
  EXPECT_THAT(log_.Text(), Not(HasSubstr("segment_begun"))) << "the first one is none";
  Scan few;
  few.points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  Track(*wire::EncodeScan(few));
  EXPECT_THAT(log_.Text(), HasSubstr("segment_begun"));
}

TEST_F(TraverseTasksTest, NothingIsKeptOfAClosedTraverse) {
  world_.Acknowledge(*journal_, DriveCloud(0));
  journal_->Close();
  EXPECT_THAT(tasks_->Track(false, {}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_TRUE(Events().empty());
  EXPECT_EQ(journal_->record().traverse.registered_scan_count(), 0U);
}

TEST_F(TraverseTasksTest, WithoutMemoryNothingIsDone) {
  world_.Acknowledge(*journal_, DriveCloud(0));
  const auto others = world_.memory.Reserve(world_.memory.total_bytes());
  ASSERT_THAT(others, IsOk());
  EXPECT_THAT(tasks_->Track(true, {}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
  EXPECT_TRUE(Events().empty());
}

TEST_F(TraverseTasksTest, OptimizesWithAllLinksThatThereAreToFind) {
  for (int i = 0; i < 3; ++i) Track(DriveCloud(i));
  const auto response = tasks_->Optimize({}, {});
  ASSERT_THAT(response, IsOk());
  EXPECT_EQ(response->link_count(), 3U) << "1-0, 2-1 and 2-0";
  EXPECT_EQ(response->rejected_link_count(), 0U);
  EXPECT_FALSE(response->unconverged());
  EXPECT_EQ(response->version(), journal_->record().traverse.trajectory_version());
  EXPECT_EQ(journal_->record().num_linked_scans, 3U);
  EXPECT_FALSE(tasks_->is_revision_due());
}

TEST_F(TraverseTasksTest, AnOptimisationThatNobodyWaitsForIsNotBegun) {
  for (int i = 0; i < 2; ++i) Track(DriveCloud(i));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(tasks_->Optimize({}, {stop.get_token(), {}}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_EQ(journal_->record().num_linked_scans, 0U);
}

TEST_F(TraverseTasksTest, TheLastAttemptAtARevisionEndsWithAWarning) {
  for (int i = 0; i < 3; ++i) Track(DriveCloud(i));
  ASSERT_THAT(tasks_->Optimize({}, {}), IsOk());  // closes a loop, without which there is nothing to be stopped
  std::stop_source stop;
  stop.request_stop();
  const Stop stopped{stop.get_token(), {}};
  EXPECT_THAT(tasks_->Revise(false, stopped), HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(tasks_->Revise(true, {}), IsOk());
  EXPECT_THAT(log_.Text(), Not(HasSubstr("revision_failed"))) << "neither a stopped nor a successful one is given up";
  EXPECT_THAT(tasks_->Revise(true, stopped), IsOk());
  EXPECT_THAT(log_.Text(), HasSubstr("revision_failed"));
}

TEST_F(TraverseTasksTest, ForgetChangesNothingButMemory) {
  Track(DriveCloud(0));
  tasks_->Forget();
  Track(DriveCloud(1));
  EXPECT_EQ(Events().at(1).result().pose().origin(), v1::POSE_ORIGIN_REGISTERED);
}

}  // namespace
}  // namespace curvereg::server
