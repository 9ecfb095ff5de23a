// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Watching a traverse and fetching its map over streams that are cut, and answers that make no sense.
#include <chrono>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/traverse_conversion.h"
#include "client/traverses.h"
#include "tests/client/fake_traverse_server.h"
#include "tests/client/scripted_server.h"
#include "tests/testing/scenes.h"
#include "wire/result_conversion.h"

namespace curvereg {
namespace {

using internal::FromWire;
using std::chrono::milliseconds;
using testing::ConnectTo;
using testing::FakeTraverseServer;
using testing::PlausibleResult;
using testing::TraverseMemory;

constexpr char kName[] = "traverses/drive";

void AddEvents(TraverseMemory& memory, int count) {
  const std::lock_guard lock(memory.mutex);
  for (int i = 0; i < count; ++i) {
    v1::WatchTraverseResponse event;
    const uint64_t number = memory.events.size();
    event.set_event(number);
    event.mutable_time()->set_seconds(1'700'000'000);
    if (number % 2 == 0) {
      *event.mutable_result() = PlausibleResult(number / 2);
    } else {
      event.mutable_revision()->set_version(number);
      *event.mutable_revision()->add_poses() = PlausibleResult(number / 2).pose();
    }
    memory.events.push_back(event);
  }
}

TEST(TraverseConversionTest, ReadsWhatOptimisationDid) {
  v1::OptimizeTraverseResponse response;
  response.set_version(3);
  response.set_link_count(20);
  response.set_loop_closure_count(4);
  response.set_rejected_link_count(2);
  response.set_max_translation_change_m(0.5);
  EXPECT_TRUE(FromWire(response).converged);
  response.set_unconverged(true);
  const OptimizationOutcome outcome = FromWire(response);
  EXPECT_EQ(outcome.version, 3U);
  EXPECT_EQ(outcome.num_links, 20);
  EXPECT_EQ(outcome.num_loop_closures, 4);
  EXPECT_EQ(outcome.num_rejected_links, 2);
  EXPECT_EQ(outcome.max_translation_change_m, 0.5);
  EXPECT_FALSE(outcome.converged);
}

TEST(TraverseClientTest, WatchesEveryEventOnceOverCutStreams) {
  TraverseMemory memory;
  memory.cut_after_sent = 4;
  AddEvents(memory, 10);
  const FakeTraverseServer server(memory);
  std::vector<uint64_t> numbers;
  WatchOptions options;
  options.existing_only = true;
  options.first_event = 1;
  const absl::Status status =
      ConnectTo(server.target())->traverses().Watch(kName, options, [&](const TraverseEvent& event) {
        numbers.push_back(event.number);
        EXPECT_EQ(std::holds_alternative<ScanResult>(event.what), event.number % 2 == 0);
        EXPECT_EQ(std::chrono::system_clock::to_time_t(event.time), 1'700'000'000);
      });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(numbers, ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(TraverseClientTest, WatchesWhatHappensLaterUntilItIsCancelled) {
  TraverseMemory memory;
  AddEvents(memory, 1);
  const FakeTraverseServer server(memory);
  std::stop_source source;
  WatchOptions options;
  options.cancellation = source.get_token();
  int count = 0;
  const absl::Status status =
      ConnectTo(server.target())->traverses().Watch(kName, options, [&](const TraverseEvent& event) {
        EXPECT_EQ(event.number, static_cast<uint64_t>(count));
        if (++count == 5) source.request_stop();
        if (count < 5) AddEvents(memory, 1);
      });
  EXPECT_TRUE(absl::IsCancelled(status)) << status;
  EXPECT_EQ(count, 5);
}

std::string PointBytes(const std::vector<Eigen::Vector3f>& points) {
  return {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Eigen::Vector3f)};
}

TEST(TraverseClientTest, DownloadsAMapOverCutStreams) {
  TraverseMemory memory;
  memory.cut_after_sent = 3;
  const std::vector<Eigen::Vector3f> points = testing::PatchPoints({}, 3000, 1);
  memory.map = PointBytes(points);
  const FakeTraverseServer server(memory);
  MapOptions options;
  int num_resumes = 0;
  options.progress = [&](const TransferProgress& progress) { num_resumes = progress.num_resumes; };
  const auto map = ConnectTo(server.target())->traverses().DownloadMap(kName, options);
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(map->points, points);
  EXPECT_EQ(map->num_cells, 3000U);
  EXPECT_GE(num_resumes, 3);
}

TEST(TraverseClientTest, BeginsAMapAnewWhenPosesWereRevised) {
  TraverseMemory memory;
  memory.cut_after_sent = 3;
  memory.map = PointBytes(testing::PatchPoints({}, 3000, 1));
  const std::vector<Eigen::Vector3f> revised = testing::PatchPoints({}, 2500, 2);
  const FakeTraverseServer server(memory);
  MapOptions options;
  bool done = false;
  options.progress = [&](const TransferProgress&) {
    if (std::exchange(done, true)) return;
    const std::lock_guard lock(memory.mutex);
    memory.map = PointBytes(revised);
    memory.map_version = 2;
    memory.cut_after_sent = 0;
  };
  const auto map = ConnectTo(server.target())->traverses().DownloadMap(kName, options);
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_EQ(map->version, 2U);
  EXPECT_EQ(map->points, revised);
}

TEST(TraverseClientTest, RefusesAnswersThatMakeNoSense) {
  v1::ScanResult result = PlausibleResult(3);
  EXPECT_TRUE(internal::FromWire(result).ok());
  for (int i = 0; i < 21; ++i) result.mutable_pose()->mutable_covariance()->add_upper_triangle(0.0);
  EXPECT_TRUE(internal::FromWire(result).ok()) << "a segment begins";
  result.mutable_pose()->mutable_covariance()->set_upper_triangle(0, -1.0);
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(result).status()));
  result.mutable_pose()->set_origin(v1::POSE_ORIGIN_UNSPECIFIED);
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(result).status()));
  result = PlausibleResult(3);
  result.mutable_pose()->mutable_t_segment_sensor()->mutable_rotation()->set_w(0.5);
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(result).status()));
  result = PlausibleResult(3);
  result.mutable_pose()->mutable_time()->set_seconds(std::numeric_limits<int64_t>::max());
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(result).status()));
  result = PlausibleResult(3);
  result.add_links()->mutable_summary()->add_translation(1.0);
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(result).status()));
  EXPECT_TRUE(absl::IsInternal(internal::FromWire(v1::WatchTraverseResponse()).status())) << "an empty event";
}

TEST(TraverseClientTest, ReadsALinkAsItTravels) {
  v1::TraverseLink link;
  link.set_source_sequence_number(7);
  link.set_target_sequence_number(2);
  link.set_loop_closure(true);
  RegistrationResult registration;
  registration.T_target_source = testing::UprightPose(1, -2, 0.4);
  registration.verdict.reasons = {Reason::kAmbiguous, Reason::kOverlapTooLow};
  registration.evidence.residual_rmse_m = 0.125;
  *link.mutable_summary() = wire::ToSummary(registration);
  const auto read = internal::FromWire(link);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->source, 7U);
  EXPECT_EQ(read->target, 2U);
  EXPECT_TRUE(read->loop_closure);
  EXPECT_FALSE(read->accepted);
  EXPECT_THAT(read->reasons, ::testing::UnorderedElementsAre(Reason::kAmbiguous, Reason::kOverlapTooLow));
  ASSERT_TRUE(read->T_target_source.has_value());
  EXPECT_TRUE(read->T_target_source->isApprox(*registration.T_target_source, 1e-6));
  EXPECT_FALSE(read->sigma.has_value());
  EXPECT_EQ(read->residual_rmse_m, 0.125);
  EXPECT_EQ(read->overlap, -1.0);
}

}  // namespace
}  // namespace curvereg
