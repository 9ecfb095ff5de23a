// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_work.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/tracking/tracking_world.h"
#include "wire/geometry_conversion.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using testing::IsNear;
using testing::IsOk;

v1::PointCloud CloudOfTwoPoints() {
  Scan few;
  few.points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  return *wire::EncodeScan(few);
}

// One traverse, whose steps are kept as an engine keeps them.
class TraverseWorkTest : public ::testing::Test {
 protected:
  TraverseWorkTest() { EXPECT_THAT(work_.Load(journal_.record()), IsOk()); }

  void Keep(TraverseStep step) {
    for (v1::WatchTraverseResponse& event : step.events) event.set_event(num_events_++);
    const absl::Status kept = journal_.Change(
        [&](TraverseRecord& record) {
          work_.Describe(record);
          return world_.store->AddStep(record, step);
        },
        absl::CancelledError("closed"));
    ASSERT_THAT(kept, IsOk());
  }
  // Acknowledges the next scan and tracks it; the step.
  TraverseStep Track(const v1::PointCloud& cloud) {
    const auto step = work_.Track(world_.Acknowledge(journal_, cloud), false, {});
    EXPECT_THAT(step, IsOk());
    if (!step.ok()) return {};
    Keep(*step);
    return *step;
  }

  TrackingWorld world_;
  const TraverseRecord record_ = world_.AddTraverse("drive");
  TraverseJournal journal_{record_};
  TraverseWork work_{world_.environment, world_.OptionsOf(record_)};
  uint64_t num_events_ = 0;
};

TEST_F(TraverseWorkTest, TheFirstScanBeginsASegment) {
  const TraverseStep step = Track(DriveCloud(0));
  ASSERT_EQ(step.events.size(), 1U);
  ASSERT_EQ(step.poses.size(), 1U);
  EXPECT_TRUE(step.links.empty());
  const v1::ScanResult& result = step.events[0].result();
  EXPECT_EQ(result.sequence_number(), 0U);
  EXPECT_EQ(result.pose().origin(), v1::POSE_ORIGIN_SEGMENT_START);
  EXPECT_THAT(*wire::FromWire(result.pose().t_segment_sensor()), IsNear(RigidTransform::Identity(), 0.0, 0.0));
}

TEST_F(TraverseWorkTest, TheSecondScanIsRegisteredWithTheFirst) {
  Track(DriveCloud(0));
  const TraverseStep step = Track(DriveCloud(1));
  ASSERT_EQ(step.links.size(), 1U);
  EXPECT_EQ(step.links[0].source, 1U);
  EXPECT_EQ(step.links[0].target, 0U);
  EXPECT_TRUE(step.links[0].result.verdict().accepted());
  EXPECT_EQ(step.links[0].result.stage_times_size(), 0) << "times are not kept";
  const v1::TrajectoryPose& pose = step.events[0].result().pose();
  EXPECT_EQ(pose.origin(), v1::POSE_ORIGIN_REGISTERED);
  EXPECT_THAT(*wire::FromWire(pose.t_segment_sensor()), IsNear(DrivePose(0).inverse() * DrivePose(1), 0.03, 0.01));
  EXPECT_EQ(journal_.record().traverse.registered_scan_count(), 2U);
  EXPECT_EQ(journal_.record().num_links, 1U);
  EXPECT_NEAR(journal_.record().traverse.path_length_m(), 0.8, 0.1);
}

TEST_F(TraverseWorkTest, AScanThatCannotBeUsedBeginsASegment) {
  Track(DriveCloud(0));
  const TraverseStep step = Track(CloudOfTwoPoints());
  const v1::ScanResult& result = step.events.at(0).result();
  EXPECT_EQ(result.pose().origin(), v1::POSE_ORIGIN_SEGMENT_START);
  EXPECT_EQ(result.pose().segment(), 1U);
  ASSERT_EQ(result.links_size(), 1);
  EXPECT_FALSE(result.links(0).summary().accepted());
}

TEST_F(TraverseWorkTest, WithoutMemoryNothingChangesAndTheSameMayBeTriedAgain) {
  Track(DriveCloud(0));
  const AcknowledgedScan scan = world_.Acknowledge(journal_, DriveCloud(1));
  {
    const auto others = world_.memory.Reserve(world_.memory.total_bytes());
    ASSERT_THAT(others, IsOk());
    EXPECT_THAT(work_.Track(scan, false, {}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
    EXPECT_THAT(work_.Track(scan, true, {}), HasReason(v1::ERROR_REASON_MEMORY_BUDGET)) << "which is no fault";
  }
  const auto step = work_.Track(scan, false, {});
  ASSERT_THAT(step, IsOk());
  EXPECT_EQ(step->events.at(0).result().pose().origin(), v1::POSE_ORIGIN_REGISTERED);
}

TEST_F(TraverseWorkTest, StopsWhenAsked) {
  const AcknowledgedScan scan = world_.Acknowledge(journal_, DriveCloud(0));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THAT(work_.Track(scan, true, {stop.get_token(), {}}), HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(work_.Track(scan, false, {}), IsOk());
}

// What is read from the database again gives the same numbers.
TEST_F(TraverseWorkTest, GoesOnWithWhatTheDatabaseHas) {
  Track(DriveCloud(0));
  Track(DriveCloud(1));
  const AcknowledgedScan scan = world_.Acknowledge(journal_, DriveCloud(2));
  const auto expected = work_.Track(scan, false, {});
  ASSERT_THAT(expected, IsOk());
  work_.Forget();
  EXPECT_FALSE(work_.is_loaded());
  ASSERT_THAT(work_.Load(journal_.record()), IsOk());
  EXPECT_TRUE(work_.is_loaded());
  const auto step = work_.Track(scan, false, {});
  ASSERT_THAT(step, IsOk());
  EXPECT_EQ(step->poses.at(0).SerializeAsString(), expected->poses.at(0).SerializeAsString());
  v1::RegistrationResult result = step->links.at(0).result;
  v1::RegistrationResult expected_result = expected->links.at(0).result;
  result.clear_total_time();
  expected_result.clear_total_time();
  EXPECT_EQ(result.SerializeAsString(), expected_result.SerializeAsString());
}

TEST_F(TraverseWorkTest, LooksAroundForLinksOfOneScanAfterTheOther) {
  for (int i = 0; i < 3; ++i) Track(DriveCloud(i));
  std::vector<StoredLink> links;
  std::vector<v1::WatchTraverseResponse> events;
  for (uint64_t i = 0; i < 3; ++i) {
    const auto step = work_.LookAround(false, {});
    ASSERT_THAT(step, IsOk());
    Keep(*step);
    EXPECT_EQ(journal_.record().num_linked_scans, i + 1);
    links.insert(links.end(), step->links.begin(), step->links.end());
    events.insert(events.end(), step->events.begin(), step->events.end());
  }
  ASSERT_EQ(links.size(), 1U) << "of 2 and 0: the neighbours have theirs already";
  EXPECT_EQ(links[0].source, 2U);
  EXPECT_EQ(links[0].target, 0U);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].links().links_size(), 1);
}

TEST_F(TraverseWorkTest, ARevisionIsOnlyDueWhereItIsAskedFor) {
  for (int i = 0; i < 2; ++i) Track(DriveCloud(i));
  EXPECT_FALSE(work_.IsRevisionDue()) << "the settings do not ask for it";
  const auto revised = work_.Revise({});
  ASSERT_THAT(revised, IsOk());
  EXPECT_TRUE(revised->revision.converged);
  EXPECT_EQ(revised->revision.num_links, 1);
  TraverseRecord record = journal_.record();
  work_.Describe(record);
  EXPECT_EQ(record.num_revised_links, 1U);
  EXPECT_EQ(record.num_revised_scans, 2U);
}

TEST_F(TraverseWorkTest, KnowsTheTimeBetweenTheLastTwoScans) {
  const auto track_at = [&](int number, int64_t seconds) {
    v1::PointCloud cloud = DriveCloud(number);
    if (seconds > 0) cloud.mutable_header()->mutable_time()->set_seconds(seconds);
    Track(cloud);
  };
  track_at(0, 100);
  EXPECT_EQ(work_.LastAcquisitionSeconds(), 0.0);
  track_at(1, 130);
  EXPECT_NEAR(work_.LastAcquisitionSeconds(), 30.0, 1e-6);  // times are kept in nanoseconds
  track_at(2, 125);
  EXPECT_EQ(work_.LastAcquisitionSeconds(), 0.0) << "the clock was set back";
  track_at(3, 0);
  EXPECT_EQ(work_.LastAcquisitionSeconds(), 0.0) << "a scan without a time";
}

}  // namespace
}  // namespace curvereg::server
