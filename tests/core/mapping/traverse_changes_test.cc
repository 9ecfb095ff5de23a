// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mapping/traverse_changes.h"

namespace curvereg {
namespace {

TrackedScan Tracked(uint64_t number, int segment, size_t num_links) {
  TrackedScan tracked;
  tracked.pose.sequence_number = number;
  tracked.pose.segment = segment;
  tracked.links.resize(num_links);
  return tracked;
}

TEST(AppendScanTest, KeepsEverythingInOrder) {
  Traverse traverse;
  AppendScan(traverse, Tracked(0, 0, 0), std::nullopt);
  AppendScan(traverse, Tracked(1, 0, 1), Prior{});
  AppendScan(traverse, Tracked(2, 1, 3), std::nullopt);
  ASSERT_EQ(traverse.poses.size(), 3U);
  EXPECT_EQ(traverse.poses[2].sequence_number, 2U);
  ASSERT_EQ(traverse.priors.size(), 3U);
  EXPECT_TRUE(traverse.priors[1].has_value());
  EXPECT_FALSE(traverse.priors[2].has_value());
  EXPECT_EQ(traverse.links.size(), 4U);
  EXPECT_EQ(traverse.num_segments, 2);
  EXPECT_EQ(traverse.version, 0U);
}

TEST(ApplyRevisionTest, CountsTheVersionUpWhenPosesChange) {
  Traverse traverse;
  AppendScan(traverse, Tracked(0, 0, 0), std::nullopt);
  AppendScan(traverse, Tracked(1, 1, 0), std::nullopt);
  ApplyRevision(traverse, TraverseRevision{});
  EXPECT_EQ(traverse.version, 0U);
  TraverseRevision revision;
  revision.poses.push_back(traverse.poses[1]);
  revision.poses[0].segment = 0;
  revision.poses[0].T_segment_scan.translation().x() = 3.0;
  ApplyRevision(traverse, revision);
  EXPECT_EQ(traverse.version, 1U);
  EXPECT_EQ(traverse.poses[1].segment, 0);
  EXPECT_EQ(traverse.poses[1].T_segment_scan.translation().x(), 3.0);
  EXPECT_EQ(traverse.num_segments, 2);  // the number of the segment that ended is not given again
}

}  // namespace
}  // namespace curvereg
