// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_scheduler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "tests/server/scheduling/busy_worker.h"
#include "tests/server/tracking/tracking_world.h"

namespace curvereg::server {
namespace {

using testing::BusyWorker;
using testing::IsOk;
using Answer = absl::StatusOr<v1::OptimizeTraverseResponse>;

class TraverseSchedulerTest : public ::testing::Test {
 protected:
  explicit TraverseSchedulerTest(const TrackingWorldOptions& options = {}) : world_(options) {
    const TraverseRecord record = world_.AddTraverse("drive");
    journal_ = std::make_shared<TraverseJournal>(record);
    scheduler_ = std::make_shared<TraverseScheduler>(
        world_.environment, journal_,
        std::make_unique<TraverseTasks>(world_.environment, world_.OptionsOf(record), journal_,
                                        std::make_shared<TraverseWatchers>()));
  }
  ~TraverseSchedulerTest() override { Close(); }
  // As the engine does.
  void Close() {
    journal_->Close();
    scheduler_->Close();
  }
  void AddScan(int number) {
    world_.Acknowledge(*journal_, DriveCloud(number));
    scheduler_->ScanAdded();
  }
  bool WaitForScans(uint64_t num_scans) {
    return BecomesTrue([&] { return journal_->record().traverse.registered_scan_count() == num_scans; });
  }
  int num_waiting() const { return world_.pool.Statistics().num_waiting; }

  TrackingWorld world_;
  std::shared_ptr<TraverseJournal> journal_;
  std::shared_ptr<TraverseScheduler> scheduler_;
};

TEST_F(TraverseSchedulerTest, TracksEachScanAndThenLooksAround) {
  for (int i = 0; i < 3; ++i) AddScan(i);
  EXPECT_TRUE(WaitForScans(3));
  EXPECT_TRUE(BecomesTrue([&] { return journal_->record().num_linked_scans == 3; }));
  EXPECT_EQ(journal_->record().num_links, 3U) << "1-0, 2-1 and 2-0";
}

TEST_F(TraverseSchedulerTest, SchedulesNothingWhereNothingIsToBeDone) {
  BusyWorker busy(world_.pool);
  scheduler_->Schedule();
  EXPECT_EQ(num_waiting(), 0);
}

TEST_F(TraverseSchedulerTest, HasOneTaskInThePoolAtATime) {
  BusyWorker busy(world_.pool);
  for (int i = 0; i < 3; ++i) AddScan(i);
  scheduler_->Schedule();
  EXPECT_EQ(num_waiting(), 1);
  busy.LetGo();
  EXPECT_TRUE(WaitForScans(3));
}

TEST_F(TraverseSchedulerTest, AnOptimisationGoesBeforeWhatWaits) {
  BusyWorker busy(world_.pool);
  std::promise<Answer> done;
  scheduler_->Optimize({}, "client", {}, [&](Answer answer) { done.set_value(std::move(answer)); });
  for (int i = 0; i < 2; ++i) AddScan(i);
  EXPECT_EQ(num_waiting(), 1);
  busy.LetGo();
  const Answer answer = done.get_future().get();
  ASSERT_THAT(answer, IsOk());
  EXPECT_EQ(answer->link_count(), 0U) << "no scan was tracked before it";
  EXPECT_TRUE(WaitForScans(2));
}

TEST_F(TraverseSchedulerTest, ClosingDropsWhatWaits) {
  BusyWorker busy(world_.pool);
  AddScan(0);
  std::vector<absl::Status> ends;
  for (int i = 0; i < 2; ++i) {
    scheduler_->Optimize({}, "client", {}, [&](const Answer& answer) { ends.push_back(answer.status()); });
  }
  EXPECT_TRUE(ends.empty());
  Close();
  ASSERT_EQ(ends.size(), 2U);
  for (const absl::Status& end : ends) EXPECT_THAT(end, HasReason(v1::ERROR_REASON_CANCELLED));
  EXPECT_EQ(num_waiting(), 0);
  busy.LetGo();
  EXPECT_EQ(journal_->record().traverse.registered_scan_count(), 0U);
}

TEST_F(TraverseSchedulerTest, NothingBeginsAfterClose) {
  Close();
  absl::Status end;
  scheduler_->Optimize({}, "client", {}, [&](const Answer& answer) { end = answer.status(); });
  EXPECT_THAT(end, HasReason(v1::ERROR_REASON_CANCELLED)) << "answered at once";
  BusyWorker busy(world_.pool);
  scheduler_->ScanAdded();
  EXPECT_EQ(num_waiting(), 0);
}

TEST_F(TraverseSchedulerTest, TriesAgainWhenMemoryIsThere) {
  auto others = world_.memory.Reserve(world_.memory.total_bytes());
  ASSERT_THAT(others, IsOk());
  AddScan(0);
  EXPECT_TRUE(BecomesTrue([&] { return world_.pool.Statistics().mean_task_seconds > 0.0; })) << "it was tried";
  EXPECT_EQ(journal_->record().traverse.registered_scan_count(), 0U);
  *others = MemoryBudget::Reservation();
  EXPECT_TRUE(WaitForScans(1));
}

class SmallPoolTest : public TraverseSchedulerTest {
 protected:
  SmallPoolTest() : TraverseSchedulerTest({.max_queue_length = 1}) {}
};

TEST_F(SmallPoolTest, ATaskThatIsRefusedIsTriedAgain) {
  BusyWorker busy(world_.pool);
  std::promise<void> ended;
  ASSERT_THAT(world_.pool.Submit({.client = "other",
                                  .cancellation = {},
                                  .run = [&](std::chrono::nanoseconds) { ended.set_value(); },
                                  .drop = [](const absl::Status&) {}}),
              IsOk());
  AddScan(0);
  EXPECT_EQ(num_waiting(), 1) << "that of the other client";
  busy.LetGo();
  ended.get_future().wait();
  EXPECT_TRUE(WaitForScans(1));
}

}  // namespace
}  // namespace curvereg::server
