// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/traverse_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using testing::IsOk;

TraverseRecord RecordOf(uint64_t num_events) {
  TraverseRecord record;
  record.num_events = num_events;
  return record;
}

TEST(TraverseJournalTest, AChangeThatSucceedsBecomesTheRecord) {
  TraverseJournal journal(RecordOf(3));
  const auto add_event = [](TraverseRecord& record) {
    ++record.num_events;
    return absl::OkStatus();
  };
  EXPECT_THAT(journal.Change(add_event, absl::CancelledError("closed")), IsOk());
  EXPECT_EQ(journal.record().num_events, 4U);
}

TEST(TraverseJournalTest, AChangeThatFailsLeavesTheRecord) {
  TraverseJournal journal(RecordOf(3));
  const auto fail = [](TraverseRecord& record) {
    ++record.num_events;
    return absl::DataLossError("disk");
  };
  EXPECT_THAT(journal.Change(fail, absl::CancelledError("closed")), HasCode(absl::StatusCode::kDataLoss));
  EXPECT_EQ(journal.record().num_events, 3U);
}

TEST(TraverseJournalTest, NothingChangesAfterClose) {
  TraverseJournal journal(RecordOf(3));
  EXPECT_FALSE(journal.is_closed());
  journal.Close();
  EXPECT_TRUE(journal.is_closed());
  bool has_run = false;
  const auto run = [&](TraverseRecord&) {
    has_run = true;
    return absl::OkStatus();
  };
  EXPECT_THAT(journal.Change(run, absl::NotFoundError("closed")), HasCode(absl::StatusCode::kNotFound));
  EXPECT_FALSE(has_run);
  EXPECT_EQ(journal.record().num_events, 3U) << "it can still be read";
}

}  // namespace
}  // namespace curvereg::server
