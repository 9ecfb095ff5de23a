// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/traverses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <vector>

#include "server/traverses/streamed_upload.h"
#include "tests/server/scheduling/busy_worker.h"
#include "tests/server/store/small_disk.h"
#include "tests/server/traverses/traverse_world.h"
#include "wire/geometry_conversion.h"

namespace curvereg::server {
namespace {

using ::testing::ElementsAre;
using testing::IsNear;
using testing::IsOk;

v1::CreateTraverseRequest CreateRequest(const std::string& id, uint32_t reorder_window = 0) {
  v1::CreateTraverseRequest request;
  request.set_traverse_id(id);
  request.mutable_settings()->set_reorder_window(reorder_window);
  return request;
}

std::vector<uint64_t> ResultNumbers(const std::vector<v1::ScanResult>& results) {
  std::vector<uint64_t> numbers;
  for (const v1::ScanResult& result : results) numbers.push_back(result.sequence_number());
  return numbers;
}

TEST(TraversesTest, TheSameRequestAgainAnswersTheSameTraverse) {
  TraverseWorld world;
  const auto made = world->Create(CreateRequest("rover-1"));
  ASSERT_THAT(made, IsOk());
  EXPECT_EQ(made->name(), "traverses/rover-1");
  const auto again = world->Create(CreateRequest("rover-1"));
  ASSERT_THAT(again, IsOk());
  EXPECT_EQ(again->SerializeAsString(), made->SerializeAsString());
  EXPECT_THAT(world->Create(CreateRequest("rover-1", 2)), HasReason(v1::ERROR_REASON_TRAVERSE_EXISTS));
  EXPECT_EQ(world->num_traverses(), 1U);
}

TEST(TraversesTest, ALostDatabaseIsSaidSo) {
  const testing::TemporaryFolder folder;
  TraverseWorld world({}, folder.path());
  const auto reopened = [&](bool is_lost) {
    world.Close();
    if (is_lost) std::filesystem::remove(folder.File("traverses.sqlite"));
    return Traverses::Open(folder.path(), {.scans = {.limits = {}, .store = &world.store()}}).status();
  };
  EXPECT_THAT(reopened(true), IsOk()) << "nothing was kept so far";
  world.Keep(DriveCloud(0));
  EXPECT_THAT(reopened(false), IsOk());
  EXPECT_THAT(reopened(true), testing::HasCode(absl::StatusCode::kDataLoss));
}

TEST(TraversesTest, RefusesWhatCannotBeATraverse) {
  TraverseWorld world({.max_traverses = 1, .max_threads_per_registration = 2});
  for (const std::string& id : {std::string(), std::string("Rover"), std::string("a/b"), std::string(65, 'a')}) {
    EXPECT_THAT(world->Create(CreateRequest(id)), HasReason(v1::ERROR_REASON_INVALID_FIELD)) << id;
  }
  EXPECT_THAT(world->Create(CreateRequest("a", 65)), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  v1::CreateTraverseRequest with_prior = CreateRequest("a");
  *with_prior.mutable_settings()->mutable_registration()->mutable_prior()->mutable_t_target_source() =
      wire::ToWire(RigidTransform::Identity());
  EXPECT_THAT(world->Create(with_prior), HasReason(v1::ERROR_REASON_INVALID_FIELD));
  EXPECT_THAT(world->Create(CreateRequest("a", 64)), IsOk());
  EXPECT_THAT(world->Create(CreateRequest("b")), HasReason(v1::ERROR_REASON_TOO_MANY_TRAVERSES));
  EXPECT_THAT(world->Find("traverses/b"), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(world->Find("b"), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST(TraversesTest, TracksADriveAndTellsEachScanOnce) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  world.AddDrive(world.Begin(name), 0, 4);
  ASSERT_TRUE(world.WaitForScans(name, 4));

  const auto results = world.Find(name)->Results(0, 100);
  ASSERT_THAT(results, IsOk());
  EXPECT_THAT(ResultNumbers(*results), ElementsAre(0, 1, 2, 3));
  for (size_t i = 0; i < results->size(); ++i) {
    const v1::TrajectoryPose& pose = (*results)[i].pose();
    const RigidTransform T_segment_sensor = *wire::FromWire(pose.t_segment_sensor());
    EXPECT_THAT(T_segment_sensor, IsNear(DrivePose(0).inverse() * DrivePose(static_cast<int>(i)), 0.03, 0.01));
    EXPECT_EQ(pose.origin(), i == 0 ? v1::POSE_ORIGIN_SEGMENT_START : v1::POSE_ORIGIN_REGISTERED);
    EXPECT_EQ((*results)[i].has_result(), i > 0);
  }
  const auto rest = world.Find(name)->Results(2, 1);
  ASSERT_THAT(rest, IsOk());
  EXPECT_THAT(ResultNumbers(*rest), ElementsAre(2));

  const v1::Traverse traverse = world.Get(name);
  EXPECT_EQ(traverse.next_sequence_number(), 4U);
  EXPECT_EQ(traverse.segment_count(), 1U);
  EXPECT_NEAR(traverse.path_length_m(), 2.4, 0.2);
  EXPECT_EQ(world.Poses(name).size(), 4U);
}

TEST(TraversesTest, CountsTheTimeBetweenScans) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  const StreamTicket ticket = world.Begin(name);
  const std::vector<std::optional<int64_t>> taken_s = {100, 130, 125, 145, std::nullopt, 200, 202};
  for (std::size_t i = 0; i < taken_s.size(); ++i) {
    v1::PointCloud cloud = DriveCloud(static_cast<int>(i));
    if (taken_s[i].has_value()) cloud.mutable_header()->mutable_time()->set_seconds(*taken_s[i]);
    ASSERT_THAT(world.Add(ticket, i, cloud), IsOk());
  }
  ASSERT_TRUE(world.WaitForScans(name, taken_s.size()));
  const auto counted = [&](const std::string& seconds) {
    const std::string line = "\ncurvereg_traverse_acquisition_seconds_total " + seconds + "\n";
    return BecomesTrue([&] { return world.metrics().Text().find(line) != std::string::npos; });
  };
  EXPECT_TRUE(counted("52")) << "neither the clock set back nor the scan without a time counts";
  world.Reopen();
  v1::PointCloud cloud = DriveCloud(7);
  cloud.mutable_header()->mutable_time()->set_seconds(210);
  ASSERT_THAT(world.Add(world.Begin(name), 7, cloud), IsOk());
  EXPECT_TRUE(counted("60")) << "a restart in between does not matter";
}

TEST(TraversesTest, EventsAreNumberedWithoutGapsAndWakeWatchers) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  std::atomic<int> num_wakes = 0;
  auto subscription = world.Find(name)->Subscribe([&] { ++num_wakes; });
  world.AddDrive(world.Begin(name), 0, 3);
  ASSERT_TRUE(world.WaitForScans(name, 3));
  ASSERT_TRUE(BecomesTrue([&] { return num_wakes >= 3; }));
  subscription.reset();

  const auto events = world.Find(name)->Events(0, 1000);
  ASSERT_THAT(events, IsOk());
  ASSERT_GE(events->size(), 3U);
  for (size_t i = 0; i < events->size(); ++i) {
    EXPECT_EQ((*events)[i].event(), i);
    EXPECT_TRUE((*events)[i].has_time());
  }
  const auto later = world.Find(name)->Events(1, 1);
  ASSERT_THAT(later, IsOk());
  ASSERT_EQ(later->size(), 1U);
  EXPECT_EQ(later->front().SerializeAsString(), (*events)[1].SerializeAsString());
  EXPECT_THAT(world.Find(name)->Events(1000, 1), HasReason(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE));
}

TEST(TraversesTest, ANewerStreamFencesOffTheOneBefore) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  const std::stop_source owner;
  const auto first = world.Find(name)->BeginStream(owner);
  ASSERT_THAT(first, IsOk());
  EXPECT_FALSE(owner.stop_requested());
  const StreamTicket second = world.Begin(name);
  EXPECT_TRUE(owner.stop_requested());
  EXPECT_GT(second.fencing_number, first->fencing_number);
  const v1::PointCloud cloud = DriveCloud(0);
  bool known = false;
  EXPECT_THAT(world.Find(*first)->CheckScan(*first, StreamedHeader(0, cloud), &known),
              HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(world.Add(*first, 0, cloud), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(world.Add(second, 0, cloud), IsOk());
  world.Reopen();
  EXPECT_THAT(world.Add(*first, 1, cloud), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_GT(world.Begin(name).fencing_number, second.fencing_number);
}

TEST(TraversesTest, AGapIsOutOfRangeWithoutAWindow) {
  TraverseWorld world;
  const StreamTicket ticket = world.Begin(world.Create("drive"));
  const auto status = world.Add(ticket, 1, DriveCloud(1)).status();
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE));
  EXPECT_EQ(wire::ErrorInfoOf(status)->metadata().at("next_sequence_number"), "0");
}

TEST(TraversesTest, LateScansWithinTheWindowAreTrackedInOrder) {
  TraverseWorld world;
  v1::TraverseSettings settings;
  settings.set_reorder_window(2);
  const std::string name = world.Create("drive", settings);
  const StreamTicket ticket = world.Begin(name);
  EXPECT_EQ(*world.Add(ticket, 2, DriveCloud(2)), 0U);
  EXPECT_THAT(world.Add(ticket, 3, DriveCloud(3)), HasReason(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE));
  // What is beyond the gap is known, also to the server that follows.
  world.Reopen();
  const StreamTicket again = world.Begin(name);
  EXPECT_EQ(again.next_sequence_number, 0U);
  bool known = false;
  EXPECT_THAT(world.Find(again)->CheckScan(again, StreamedHeader(2, DriveCloud(2)), &known), IsOk());
  EXPECT_TRUE(known);
  EXPECT_EQ(*world.Add(again, 1, DriveCloud(1)), 0U);
  EXPECT_EQ(world.Get(name).registered_scan_count(), 0U);
  EXPECT_EQ(*world.Add(again, 0, DriveCloud(0)), 3U);
  ASSERT_TRUE(world.WaitForScans(name, 3));
  EXPECT_THAT(ResultNumbers(*world.Find(name)->Results(0, 10)), ElementsAre(0, 1, 2));
}

TEST(TraversesTest, AScanAgainChangesNothingAndAnotherInItsPlaceIsRefused) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  const StreamTicket ticket = world.Begin(name);
  world.AddDrive(ticket, 0, 2);
  ASSERT_TRUE(world.WaitForScans(name, 2));
  bool known = false;
  EXPECT_THAT(world.Find(ticket)->CheckScan(ticket, StreamedHeader(1, DriveCloud(1)), &known), IsOk());
  EXPECT_TRUE(known);
  EXPECT_EQ(*world.Add(ticket, 1, DriveCloud(1)), 2U);
  EXPECT_THAT(world.Find(ticket)->CheckScan(ticket, StreamedHeader(1, DriveCloud(2)), &known),
              HasReason(v1::ERROR_REASON_SEQUENCE_DIFFERS));
  EXPECT_THAT(world.Add(ticket, 1, DriveCloud(2)), HasReason(v1::ERROR_REASON_SEQUENCE_DIFFERS));
  EXPECT_THAT(world.Find(ticket)->CheckScan(ticket, StreamedHeader(2, DriveCloud(2)), &known), IsOk());
  EXPECT_FALSE(known);
  EXPECT_EQ(world.Get(name).next_sequence_number(), 2U);
}

TEST(TraversesTest, AFullTraverseTakesNoMoreScans) {
  TraverseWorld world({.max_scans_per_traverse = 1, .max_threads_per_registration = 2});
  const StreamTicket ticket = world.Begin(world.Create("drive"));
  world.AddDrive(ticket, 0, 1);
  EXPECT_THAT(world.Add(ticket, 1, DriveCloud(1)), HasReason(v1::ERROR_REASON_TRAVERSE_FULL));
}

TEST(TraversesTest, ScansThatAreNotStoredAreNotTaken) {
  TraverseWorld world;
  const StreamTicket ticket = world.Begin(world.Create("drive"));
  EXPECT_THAT(world.Find(ticket)->AddScan(ticket, StreamedHeader(0, DriveCloud(0)), std::string(32, '0')),
              HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

// What was acknowledged is tracked after a restart, once and with the same poses, whenever the server stopped.
TEST(TraversesTest, GoesOnAfterARestartWithTheSamePoses) {
  TraverseWorld world;
  const std::string whole = world.Create("whole");
  world.AddDrive(world.Begin(whole), 0, 6);
  ASSERT_TRUE(world.WaitForScans(whole, 6));
  const std::string cut = world.Create("cut");
  for (int i = 0; i < 6; i += 2) {
    world.AddDrive(world.Begin(cut), i, i + 2);
    if (i > 0) {
      ASSERT_TRUE(world.WaitForScans(cut, static_cast<uint64_t>(i) + 1));
    }
    world.Reopen();
  }
  ASSERT_TRUE(world.WaitForScans(cut, 6));
  const auto results = world.Find(cut)->Results(0, 100);
  ASSERT_THAT(results, IsOk());
  EXPECT_THAT(ResultNumbers(*results), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(world.PoseBytes(cut), world.PoseBytes(whole));
  const auto events = world.Find(cut)->Events(0, 1000);
  ASSERT_THAT(events, IsOk());
  for (size_t i = 0; i < events->size(); ++i) EXPECT_EQ((*events)[i].event(), i);
}

TEST(TraversesTest, SixteenAtOnceGetThePosesThatTheyGetAlone) {
  constexpr int kNumTraverses = 16;
  constexpr int kNumScans = 3;
  TraverseWorld world;
  world.max_queue_length = 4;  // so that some are refused and come again
  world.Reopen();
  std::vector<std::string> names;
  std::vector<StreamTicket> tickets;
  for (int i = 0; i < kNumTraverses; ++i) {
    names.push_back(world.Create("rover-" + std::to_string(i)));
    tickets.push_back(world.Begin(names.back()));
  }
  for (int scan = 0; scan < kNumScans; ++scan) {
    for (int i = 0; i < kNumTraverses; ++i) {
      world.AddDrive(tickets[static_cast<size_t>(i)], scan, scan + 1, static_cast<uint64_t>(i % 2));
    }
  }
  for (const std::string& name : names) ASSERT_TRUE(world.WaitForScans(name, kNumScans)) << name;
  for (uint64_t drive : {0, 1}) {
    const std::string alone = world.Create("alone-" + std::to_string(drive));
    world.AddDrive(world.Begin(alone), 0, kNumScans, drive);
    ASSERT_TRUE(world.WaitForScans(alone, kNumScans));
    for (size_t i = drive; i < names.size(); i += 2) EXPECT_EQ(world.PoseBytes(names[i]), world.PoseBytes(alone));
  }
  EXPECT_NE(world.PoseBytes("traverses/alone-0"), world.PoseBytes("traverses/alone-1"));
}

TEST(TraversesTest, AnUnusableScanDoesNotHoldUpTheTraverse) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  const StreamTicket ticket = world.Begin(name);
  world.AddDrive(ticket, 0, 1);
  Scan few;
  few.points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  EXPECT_THAT(world.Add(ticket, 1, *wire::EncodeScan(few)), IsOk());
  world.AddDrive(ticket, 2, 4);
  ASSERT_TRUE(world.WaitForScans(name, 4));
  const auto results = world.Find(name)->Results(1, 1);
  ASSERT_THAT(results, IsOk());
  ASSERT_EQ(results->front().links_size(), 1);
  EXPECT_FALSE(results->front().links(0).summary().accepted());
  EXPECT_FALSE(results->front().has_result());
  const std::vector<v1::TrajectoryPose> poses = world.Poses(name);
  EXPECT_EQ(poses[1].origin(), v1::POSE_ORIGIN_SEGMENT_START);
  EXPECT_EQ(poses[3].origin(), v1::POSE_ORIGIN_REGISTERED);
}

TEST(TraversesTest, APriorCarriesAScanThatCannotBeRegistered) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  const StreamTicket ticket = world.Begin(name);
  world.AddDrive(ticket, 0, 1);
  Scan few;
  few.points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  const v1::PointCloud cloud = *wire::EncodeScan(few);
  v1::StreamedScanHeader header = StreamedHeader(1, cloud);
  const RigidTransform T_target_source = DrivePose(0).inverse() * DrivePose(1);
  *header.mutable_prior()->mutable_t_target_source() = wire::ToWire(T_target_source);
  *header.mutable_prior()->mutable_covariance() = wire::ToWire(Matrix6d(1e-4 * Matrix6d::Identity()));
  ASSERT_THAT(world.Find(ticket)->AddScan(ticket, header, world.Keep(cloud)), IsOk());
  ASSERT_TRUE(world.WaitForScans(name, 2));
  const v1::TrajectoryPose pose = world.Poses(name).back();
  EXPECT_EQ(pose.origin(), v1::POSE_ORIGIN_PRIOR);
  EXPECT_EQ(pose.segment(), 0U);
  EXPECT_THAT(*wire::FromWire(pose.t_segment_sensor()), IsNear(T_target_source, 1e-9, 1e-9));
}

TEST(TraversesTest, TrajectoriesComeInPages) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  world.AddDrive(world.Begin(name), 0, 3);
  ASSERT_TRUE(world.WaitForScans(name, 3));
  const auto first = world.Find(name)->Trajectory(2, "");
  ASSERT_THAT(first, IsOk());
  ASSERT_EQ(first->poses_size(), 2);
  const auto last = world.Find(name)->Trajectory(2, first->next_page_token());
  ASSERT_THAT(last, IsOk());
  ASSERT_EQ(last->poses_size(), 1);
  EXPECT_EQ(last->poses(0).sequence_number(), 2U);
  EXPECT_EQ(last->next_page_token(), "");
  EXPECT_THAT(world.Find(name)->Trajectory(2, "1"), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST(TraversesTest, ListsTheNewestFirstInPages) {
  TraverseWorld world;
  for (const char* id : {"b", "a", "c"}) world.Create(id);
  world.Reopen();
  v1::ListTraversesRequest request;
  request.set_page_size(2);
  const auto first = world->List(request);
  ASSERT_THAT(first, IsOk());
  ASSERT_EQ(first->traverses_size(), 2);
  EXPECT_EQ(first->traverses(0).name(), "traverses/c");
  EXPECT_EQ(first->traverses(1).name(), "traverses/a");
  request.set_page_token(first->next_page_token());
  const auto last = world->List(request);
  ASSERT_THAT(last, IsOk());
  ASSERT_EQ(last->traverses_size(), 1);
  EXPECT_EQ(last->traverses(0).name(), "traverses/b");
  EXPECT_EQ(last->next_page_token(), "");
  request.set_page_size(-1);
  EXPECT_THAT(world->List(request), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST(TraversesTest, DeletionTakesScansThatNothingElseUses) {
  TraverseWorld world;
  const std::string name = world.Create("gone");
  const std::string other = world.Create("other");
  const std::string shared = world.Keep(DriveCloud(0));
  const std::string own = world.Keep(DriveCloud(1));
  const std::stop_source owner;
  const auto ticket = world.Find(name)->BeginStream(owner);
  world.AddDrive(*ticket, 0, 2);
  world.AddDrive(world.Begin(other), 0, 1);
  EXPECT_THAT(world->DeleteScan(own), HasReason(v1::ERROR_REASON_SCAN_IN_USE));
  std::atomic<bool> is_woken = false;
  const auto subscription = world.Find(name)->Subscribe([&] { is_woken = true; });
  ASSERT_THAT(world->Delete(name), IsOk());
  EXPECT_TRUE(is_woken);
  EXPECT_FALSE(owner.stop_requested()) << "its stream is not replaced, it finds the traverse gone";
  EXPECT_THAT(world->Find(name), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(world->Delete(name), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(world.store().GetScan(own), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_THAT(world.store().GetScan(shared), IsOk());
  // A stream of it has no rights in another of the same name.
  world.Create("gone");
  EXPECT_THAT(world.Add(*ticket, 0, DriveCloud(0)), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_TRUE(world.Poses(name).empty());
  EXPECT_THAT(world.Find(name)->Events(0, 10),
              ::testing::Property(&absl::StatusOr<std::vector<v1::WatchTraverseResponse>>::ok, true));
}

TEST(TraversesTest, DeletionForgetsAScanThatIsOnItsWay) {
  TraverseWorld world;
  const std::string name = world.Create("gone", CreateRequest("gone", 2).settings());
  world.AddDrive(world.Begin(name), 0, 1);
  const v1::PointCloud cloud = DriveCloud(1);
  for (const uint64_t number : {1, 3}) {
    const UploadDescription description = {StreamedUploadId("gone", number), cloud.header(), cloud.data().size(), {}};
    ASSERT_THAT(world.store().BeginUpload(description).value()->Append(0, cloud.data().substr(0, 100)), IsOk());
  }
  ASSERT_THAT(world->Delete(name), IsOk());
  EXPECT_EQ(world.store().Statistics().num_uploads, 0U);
}

// A scan cannot be deleted while a traverse uses it: then the traverse must be deletable.
TEST(TraversesTest, DeletionNeedsNoRoomOnTheDisk) {
  testing::SmallDisk disk("48m");
  if (const std::string problem = disk.Mount(); !problem.empty()) GTEST_SKIP() << problem;
  TraverseWorld world({.max_threads_per_registration = 2}, disk.File("data"));
  const std::string name = world.Create("gone");
  world.AddDrive(world.Begin(name), 0, 2);
  ASSERT_TRUE(world.WaitForScans(name, 2));
  const std::string scan = world.Keep(DriveCloud(0));
  disk.FillUp(0);
  world.Reopen();
  ASSERT_THAT(world->Delete(name), IsOk());
  EXPECT_THAT(world.store().GetScan(scan), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(world->num_traverses(), 0U);
}

TEST(TraversesTest, StaysWhenTheDiskHasNoRoomToDeleteIt) {
  testing::SmallDisk disk("48m");
  if (const std::string problem = disk.Mount(); !problem.empty()) GTEST_SKIP() << problem;
  TraverseWorld world({.max_threads_per_registration = 2}, disk.File("data"));
  const std::string name = world.Create("kept");
  const std::stop_source owner;
  const auto ticket = world.Find(name)->BeginStream(owner);
  world.AddDrive(*ticket, 0, 1);
  ASSERT_TRUE(world.WaitForScans(name, 1));
  std::filesystem::remove(disk.File("data/spare"));
  disk.FillUp(0);
  EXPECT_THAT(world->Delete(name), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_TRUE(owner.stop_requested()) << "its stream begins anew";
  disk.MakeRoom();
  world.AddDrive(world.Begin(name), 1, 2);
  EXPECT_TRUE(world.WaitForScans(name, 2));
  EXPECT_THAT(world->Delete(name), IsOk());
}

absl::StatusOr<v1::OptimizeTraverseResponse> Optimized(TraverseWorld& world, const std::string& name) {
  v1::OptimizeTraverseRequest request;
  request.set_name(name);
  request.set_find_loop_closures(true);
  std::promise<absl::StatusOr<v1::OptimizeTraverseResponse>> done;
  world.Find(name)->Optimize(request, "client", {}, [&](auto answer) { done.set_value(std::move(answer)); });
  return done.get_future().get();
}

TEST(TraversesTest, OptimizesWithAllLinksThatThereAreToFind) {
  TraverseWorld world;
  const std::string name = world.Create("drive");
  world.AddDrive(world.Begin(name), 0, 4);
  ASSERT_TRUE(world.WaitForScans(name, 4));
  const auto response = Optimized(world, name);
  ASSERT_THAT(response, IsOk());
  EXPECT_EQ(response->link_count(), 6U) << "every scan with every other: the drive is short";
  EXPECT_FALSE(response->unconverged());
  EXPECT_EQ(response->version(), world.Get(name).trajectory_version());
  const auto source = world.Find(name)->ScansOfSegment(0);
  ASSERT_THAT(source, IsOk());
  EXPECT_EQ(source->scan_ids.size(), 4U);
  EXPECT_EQ(source->version, response->version());
  EXPECT_THAT(source->T_segment_scan[3], IsNear(DrivePose(0).inverse() * DrivePose(3), 0.03, 0.01));
  EXPECT_THAT(world.Find(name)->ScansOfSegment(7), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST(TraversesTest, AnOptimizationThatIsNotWantedAnyMoreIsDropped) {
  TraverseWorld world;
  world.Reopen(1);
  const std::string name = world.Create("drive");
  testing::BusyWorker busy(world.pool());
  v1::OptimizeTraverseRequest request;
  request.set_name(name);
  std::stop_source caller;
  absl::Status status;
  world.Find(name)->Optimize(request, "client", {caller.get_token(), {}},
                             [&](const auto& answer) { status = answer.status(); });
  caller.request_stop();
  EXPECT_THAT(status, HasReason(v1::ERROR_REASON_CANCELLED));
  EXPECT_THAT(world->Find("traverses/none"), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  busy.LetGo();
}

TEST(TraversesTest, RefusesOptimisationsThatWouldPileUp) {
  TraverseWorld world;
  world.Reopen(1);
  v1::OptimizeTraverseRequest request;
  request.set_name(world.Create("drive"));
  const std::shared_ptr<TrackedTraverse> traverse = world.Find(request.name());
  testing::BusyWorker busy(world.pool());
  constexpr int kAsked = 100;
  std::atomic<int> num_done = 0, num_refused = 0;
  for (int i = 0; i < kAsked; ++i) {
    traverse->Optimize(request, "client", {}, [&](const auto& answer) {
      if (answer.ok()) ++num_done;
      if (wire::ReasonOf(answer.status()) == v1::ERROR_REASON_QUEUE_FULL) ++num_refused;
    });
  }
  EXPECT_GE(num_refused, kAsked / 2);
  busy.LetGo();
  EXPECT_TRUE(BecomesTrue([&] { return num_done + num_refused == kAsked; }));
  EXPECT_GE(num_done, 2);
}

}  // namespace
}  // namespace curvereg::server
