// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/mapping/track_scan.h"
#include "core/mapping/traverse_changes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::DriveScans;
using testing::HasCode;
using testing::IsNear;
using testing::IsOk;

constexpr double kNearM = 0.03;
constexpr double kNearRad = 0.003;

class TrackScanTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    drive_ = std::make_unique<DriveScans>(*sim::Simulation::Create(testing::SmallDrive(4)));
    elsewhere_ = testing::ScanElsewhere();
    tracked_ = std::make_unique<Traverse>(testing::TrackDrive(*drive_));
  }
  static void TearDownTestSuite() {
    drive_.reset();
    elsewhere_.reset();
    tracked_.reset();
  }

  // The first `count` scans of the drive, tracked.
  static Traverse Beginning(size_t count) {
    Traverse traverse = *tracked_;
    traverse.poses.resize(count);
    traverse.priors.resize(count);
    std::erase_if(traverse.links, [&](const TraverseLink& link) { return link.source >= count; });
    return traverse;
  }

  static TraverseScan ScanOf(uint64_t number) { return {drive_->Get(number), std::nullopt, std::nullopt}; }
  static TraverseScan ScanFromElsewhere() { return {elsewhere_, std::nullopt, std::nullopt}; }

  // The drive's scans with a scan from elsewhere as scan `number`.
  static TraverseScanLoader LoaderWithScanElsewhere(uint64_t number) {
    return [number](uint64_t wanted, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
      if (wanted == number) return elsewhere_;
      return drive_->Get(wanted);
    };
  }

  static RigidTransform TruePose(uint64_t number) { return drive_->TrueMotion(0, number); }

  static inline std::unique_ptr<DriveScans> drive_;
  static inline std::shared_ptr<const PreparedScan> elsewhere_;
  static inline std::unique_ptr<Traverse> tracked_;
};

TEST_F(TrackScanTest, TheFirstScanBeginsASegment) {
  TraverseScan scan = ScanOf(0);
  scan.time_ns = 123;
  scan.prior = Prior{};
  const auto tracked = TrackScan(Traverse{}, scan, drive_->Loader(), {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.sequence_number, 0U);
  EXPECT_EQ(tracked->pose.time_ns, 123);
  EXPECT_EQ(tracked->pose.segment, 0);
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kSegmentStart);
  EXPECT_THAT(tracked->pose.T_segment_scan, IsNear(RigidTransform::Identity(), 0.0, 0.0));
  EXPECT_TRUE(tracked->links.empty());
  EXPECT_EQ(tracked->deciding_link, -1);
}

TEST_F(TrackScanTest, OneRegistrationPerScan) {
  ASSERT_EQ(tracked_->poses.size(), 4U);
  ASSERT_EQ(tracked_->links.size(), 3U);
  EXPECT_EQ(tracked_->num_segments, 1);
  double last_variance = 0.0;
  for (uint64_t number = 1; number < 4; ++number) {
    const TrajectoryPose& pose = tracked_->poses[number];
    EXPECT_EQ(pose.origin, PoseOrigin::kRegistered);
    EXPECT_EQ(pose.segment, 0);
    EXPECT_THAT(pose.T_segment_scan, IsNear(TruePose(number), kNearM, kNearRad));
    const TraverseLink& link = tracked_->links[number - 1];
    EXPECT_EQ(link.source, number);
    EXPECT_EQ(link.target, number - 1);
    EXPECT_EQ(link.kind, LinkKind::kTracking);
    ASSERT_TRUE(pose.covariance.has_value());
    EXPECT_EQ(Eigen::LLT<Matrix6d>(*pose.covariance).info(), Eigen::Success);
    EXPECT_GT(pose.covariance->trace(), last_variance);
    last_variance = pose.covariance->trace();
  }
}

TEST_F(TrackScanTest, WithoutOdometryARejectedScanBeginsASegment) {
  Traverse traverse = Beginning(3);
  traverse.num_segments = 5;  // others have begun and ended
  const auto tracked = TrackScan(traverse, ScanFromElsewhere(), drive_->Loader(), {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kSegmentStart);
  EXPECT_EQ(tracked->pose.segment, 5);
  EXPECT_EQ(tracked->deciding_link, -1);
  ASSERT_EQ(tracked->links.size(), 3U);  // the predecessor and both others
  EXPECT_EQ(tracked->links[0].target, 2U);
  for (const TraverseLink& link : tracked->links) EXPECT_FALSE(link.result.verdict.accepted);
}

TEST_F(TrackScanTest, WithOdometryARejectedScanIsCarried) {
  const Traverse traverse = Beginning(3);
  TraverseScan scan = ScanFromElsewhere();
  scan.prior = drive_->Odometry(3, 0.05);
  const auto tracked = TrackScan(traverse, scan, drive_->Loader(), {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kPrior);
  EXPECT_EQ(tracked->pose.segment, 0);
  EXPECT_EQ(tracked->deciding_link, -1);
  EXPECT_THAT(tracked->pose.T_segment_scan,
              IsNear(traverse.poses[2].T_segment_scan * scan.prior->T_target_source, 1e-9, 1e-9));
  ASSERT_TRUE(tracked->pose.covariance.has_value());
  EXPECT_GT((*tracked->pose.covariance)(5, 5), (*scan.prior->covariance)(5, 5));
}

TEST_F(TrackScanTest, AGuessOfUnknownErrorCarriesNothing) {
  TraverseScan scan = ScanFromElsewhere();
  scan.prior = Prior{drive_->TrueMotion(2, 3), std::nullopt};
  const auto tracked = TrackScan(Beginning(3), scan, drive_->Loader(), {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kSegmentStart);
}

TEST_F(TrackScanTest, OneUnusableScanDoesNotCutTheTraverse) {
  Traverse traverse = Beginning(2);
  const auto elsewhere = TrackScan(traverse, ScanFromElsewhere(), drive_->Loader(), {});
  ASSERT_THAT(elsewhere, IsOk());
  AppendScan(traverse, *elsewhere, std::nullopt);
  EXPECT_EQ(traverse.num_segments, 2);
  const auto tracked = TrackScan(traverse, ScanOf(2), LoaderWithScanElsewhere(2), {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kRegistered);
  EXPECT_EQ(tracked->pose.segment, 0);
  EXPECT_EQ(tracked->deciding_link, 1);
  ASSERT_EQ(tracked->links.size(), 2U);
  EXPECT_FALSE(tracked->links[0].result.verdict.accepted);
  EXPECT_EQ(tracked->links[1].target, 1U);
  EXPECT_THAT(tracked->pose.T_segment_scan, IsNear(TruePose(2), kNearM, kNearRad));
}

TEST_F(TrackScanTest, ScansThatAreNotKeptArePassedOver) {
  const auto load = [](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    if (number == 2) return absl::NotFoundError("not kept");
    return drive_->Get(number);
  };
  const auto tracked = TrackScan(Beginning(3), ScanOf(3), load, {});
  ASSERT_THAT(tracked, IsOk());
  ASSERT_EQ(tracked->links.size(), 1U);
  EXPECT_EQ(tracked->links[0].target, 1U);
  EXPECT_THAT(tracked->pose.T_segment_scan, IsNear(TruePose(3), kNearM, kNearRad));
}

TEST_F(TrackScanTest, ScansThatAreNotKeptDoNotUseUpTheNeighbours) {
  const auto load = [](uint64_t number, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    if (number != 0) return absl::NotFoundError("not kept");
    return drive_->Get(number);
  };
  TrackingOptions options;
  options.num_tracking_neighbours = 1;
  const auto tracked = TrackScan(Beginning(3), ScanOf(3), load, options);
  ASSERT_THAT(tracked, IsOk());
  ASSERT_EQ(tracked->links.size(), 1U);
  EXPECT_EQ(tracked->links[0].target, 0U);
  EXPECT_THAT(tracked->pose.T_segment_scan, IsNear(TruePose(3), kNearM, kNearRad));
}

TEST_F(TrackScanTest, NotEveryScanIsAskedForWhenNoneIsKept) {
  Traverse traverse;
  for (int i = 0; i < 500; ++i)
    AppendScan(traverse, {PoseWithoutLink(traverse, std::nullopt, std::nullopt), {}, -1}, {});
  int num_asked = 0;
  const auto none = [&](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    ++num_asked;
    return absl::NotFoundError("not kept");
  };
  const auto tracked = TrackScan(traverse, ScanOf(3), none, {});
  ASSERT_THAT(tracked, IsOk());
  EXPECT_EQ(tracked->pose.origin, PoseOrigin::kSegmentStart);
  EXPECT_EQ(tracked->pose.segment, 500);
  EXPECT_GE(num_asked, 10);
  EXPECT_LE(num_asked, 100);
}

TEST_F(TrackScanTest, ErrorsAreHandedOn) {
  const auto broken = [](uint64_t, const Stop&) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
    return absl::DataLossError("broken");
  };
  EXPECT_THAT(TrackScan(Beginning(3), ScanOf(3), broken, {}), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_THAT(TrackScan(Beginning(3), {}, drive_->Loader(), {}), HasCode(absl::StatusCode::kInvalidArgument));
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(TrackScan(Beginning(3), ScanOf(3), drive_->Loader(), {}, {source.get_token(), std::nullopt}),
              HasCode(absl::StatusCode::kCancelled));
  EXPECT_THAT(TrackScan(Beginning(3), ScanOf(3), drive_->Loader(), {}, {{}, std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
}

TEST_F(TrackScanTest, SameBytesAtAnyThreadCount) {
  std::vector<TrackedScan> answers;
  for (const int num_threads : {1, 2, 4}) {
    TrackingOptions options;
    options.registration.num_threads = num_threads;
    const auto tracked = TrackScan(Beginning(3), ScanOf(3), drive_->Loader(), options);
    ASSERT_THAT(tracked, IsOk());
    answers.push_back(*tracked);
  }
  for (const TrackedScan& answer : answers) {
    EXPECT_EQ(answer.pose.T_segment_scan.matrix(), answers[0].pose.T_segment_scan.matrix());
    EXPECT_EQ(*answer.pose.covariance, *answers[0].pose.covariance);
  }
}

}  // namespace
}  // namespace curvereg
