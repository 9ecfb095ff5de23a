// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/scan_admission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/server/tracking/tracking_world.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

// A traverse with a window of two, whose scans are never tracked.
class ScanAdmissionTest : public ::testing::Test {
 protected:
  explicit ScanAdmissionTest(const TrackingWorldOptions& options = {}) : world_(options) {
    v1::TraverseSettings settings;
    settings.set_reorder_window(2);
    journal_ = std::make_shared<TraverseJournal>(world_.AddTraverse("drive", settings));
    admission_ = std::make_unique<ScanAdmission>(world_.environment, journal_, std::set<uint64_t>());
  }

  StreamTicket Begin(const std::stop_source& owner = std::stop_source(std::nostopstate)) {
    const auto ticket = admission_->BeginStream(owner);
    EXPECT_THAT(ticket, IsOk());
    return ticket.value_or(StreamTicket());
  }
  const v1::PointCloud& Cloud(int number) {
    const auto found = clouds_.find(number);
    return found != clouds_.end() ? found->second : clouds_.emplace(number, DriveCloud(number)).first->second;
  }
  absl::StatusOr<uint64_t> Add(const StreamTicket& ticket, uint64_t sequence_number) {
    const v1::PointCloud& cloud = Cloud(static_cast<int>(sequence_number));
    return admission_->AddScan(ticket, StreamedHeader(sequence_number, cloud), world_.Keep(cloud));
  }
  // Whether it is known, where OK.
  absl::StatusOr<bool> Check(const StreamTicket& ticket, uint64_t sequence_number, int cloud) {
    bool known = false;
    const absl::Status status = admission_->CheckScan(ticket, StreamedHeader(sequence_number, Cloud(cloud)), &known);
    if (!status.ok()) return status;
    return known;
  }

  TrackingWorld world_;
  std::shared_ptr<TraverseJournal> journal_;
  std::unique_ptr<ScanAdmission> admission_;
  std::map<int, v1::PointCloud> clouds_;
};

TEST_F(ScanAdmissionTest, ATicketSaysWhereTheTraverseStands) {
  const StreamTicket ticket = Begin();
  EXPECT_EQ(ticket.traverse_id, "drive");
  EXPECT_EQ(ticket.next_sequence_number, 0U);
  EXPECT_EQ(ticket.reorder_window, 2U);
  EXPECT_GT(ticket.fencing_number, 0U);
  EXPECT_EQ(journal_->record().fencing_number, ticket.fencing_number);
}

TEST_F(ScanAdmissionTest, TheLastStreamFencesOffTheOneBefore) {
  const std::stop_source owner;
  const StreamTicket first = Begin(owner);
  EXPECT_FALSE(owner.stop_requested());
  const StreamTicket second = Begin();
  EXPECT_TRUE(owner.stop_requested());
  EXPECT_GT(second.fencing_number, first.fencing_number);
  EXPECT_THAT(Check(first, 0, 0), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(Add(first, 0), HasReason(v1::ERROR_REASON_WRITER_REPLACED));
  EXPECT_THAT(Add(second, 0), IsOk());
}

TEST_F(ScanAdmissionTest, EndStreamStopsTheOwner) {
  const std::stop_source owner;
  Begin(owner);
  admission_->EndStream();
  EXPECT_TRUE(owner.stop_requested());
}

TEST_F(ScanAdmissionTest, TheWindowLiesBeyondTheNextNumber) {
  const StreamTicket ticket = Begin();
  const auto beyond = Add(ticket, 3);
  EXPECT_THAT(beyond, HasReason(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE));
  EXPECT_EQ(wire::ErrorInfoOf(beyond.status())->metadata().at("next_sequence_number"), "0");
  EXPECT_EQ(*Add(ticket, 2), 0U);
  EXPECT_EQ(*Add(ticket, 0), 1U);
  EXPECT_THAT(Add(ticket, 4), HasReason(v1::ERROR_REASON_SEQUENCE_OUT_OF_RANGE));
  EXPECT_EQ(*Add(ticket, 1), 3U) << "the gap before 2 is closed";
  EXPECT_EQ(journal_->record().traverse.next_sequence_number(), 3U);
  EXPECT_EQ(Begin().next_sequence_number, 3U);
}

TEST_F(ScanAdmissionTest, TheSameScanAgainIsKnownAndAnotherInItsPlaceDiffers) {
  const StreamTicket ticket = Begin();
  EXPECT_FALSE(*Check(ticket, 0, 0));
  ASSERT_THAT(Add(ticket, 0), IsOk());
  ASSERT_THAT(Add(ticket, 2), IsOk());
  EXPECT_TRUE(*Check(ticket, 0, 0));
  EXPECT_TRUE(*Check(ticket, 2, 2)) << "also beyond the gap";
  EXPECT_EQ(*Add(ticket, 0), 1U);
  EXPECT_THAT(Check(ticket, 0, 1), HasReason(v1::ERROR_REASON_SEQUENCE_DIFFERS));
  EXPECT_THAT(admission_->AddScan(ticket, StreamedHeader(0, Cloud(0)), world_.Keep(Cloud(1))),
              HasReason(v1::ERROR_REASON_SEQUENCE_DIFFERS));
  EXPECT_EQ(journal_->record().traverse.next_sequence_number(), 1U);
}

TEST_F(ScanAdmissionTest, DigestsOfTwoAlgorithmsLeaveItToTheStoredScan) {
  const StreamTicket ticket = Begin();
  ASSERT_THAT(Add(ticket, 0), IsOk());
  v1::StreamedScanHeader header = StreamedHeader(0, Cloud(0));
  header.mutable_payload_digest()->set_algorithm(v1::DIGEST_ALGORITHM_SHA256);
  header.mutable_payload_digest()->set_value(std::string(32, 'd'));
  bool known = false;
  EXPECT_THAT(admission_->CheckScan(ticket, header, &known), IsOk());
  EXPECT_TRUE(known);
}

TEST_F(ScanAdmissionTest, NumbersBeyondTheGapAreKnownAfterARestart) {
  ASSERT_THAT(Add(Begin(), 1), IsOk());
  admission_ = std::make_unique<ScanAdmission>(world_.environment, journal_, std::set<uint64_t>{1});
  const StreamTicket ticket = Begin();
  EXPECT_TRUE(*Check(ticket, 1, 1));
  EXPECT_EQ(*Add(ticket, 0), 2U);
}

TEST_F(ScanAdmissionTest, AScanThatIsNotStoredIsNotAdmitted) {
  EXPECT_THAT(admission_->AddScan(Begin(), StreamedHeader(0, Cloud(0)), std::string(32, '0')),
              HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  EXPECT_EQ(journal_->record().traverse.next_sequence_number(), 0U);
}

TEST_F(ScanAdmissionTest, AnUnreadablePriorIsRefused) {
  const StreamTicket ticket = Begin();
  v1::StreamedScanHeader header = StreamedHeader(0, Cloud(0));
  header.mutable_prior()->mutable_t_target_source();  // a rotation of length zero
  bool known = false;
  EXPECT_THAT(admission_->CheckScan(ticket, header, &known), HasReason(v1::ERROR_REASON_INVALID_FIELD));
}

TEST_F(ScanAdmissionTest, AClosedTraverseIsGone) {
  const StreamTicket ticket = Begin();
  journal_->Close();
  EXPECT_THAT(Check(ticket, 0, 0), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(Add(ticket, 0), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
  EXPECT_THAT(admission_->BeginStream(std::stop_source()), HasReason(v1::ERROR_REASON_TRAVERSE_NOT_FOUND));
}

class FullTraverseTest : public ScanAdmissionTest {
 protected:
  FullTraverseTest() : ScanAdmissionTest({.limits = {.max_scans_per_traverse = 1}}) {}
};

TEST_F(FullTraverseTest, TakesNoMoreScans) {
  const StreamTicket ticket = Begin();
  ASSERT_THAT(Add(ticket, 0), IsOk());
  const auto refused = Add(ticket, 1);
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_TRAVERSE_FULL));
  EXPECT_EQ(wire::ErrorInfoOf(refused.status())->metadata().at("limit"), "1");
}

}  // namespace
}  // namespace curvereg::server
