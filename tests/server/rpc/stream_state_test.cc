// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/stream_state.h"

#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "wire/error.h"

namespace curvereg::server {
namespace {

using Output = StreamState::Output;

const absl::Status kFault = absl::InternalError("fault");
const absl::Status kGone = absl::CancelledError("gone");

// A stream without messages: it keeps the lengths of the queues and does at each step what the state says.
class StreamStateTest : public ::testing::Test {
 protected:
  // What was started by the last step.
  struct Started {
    Output output = Output::kNothing;
    StreamState::Task task;
    bool read = false;
  };

  Started Advance() {
    Started started;
    if (state_.is_finished()) return started;
    state_.EndIfIdle(pending_, [this] { return end_of_input_; });
    started.output = state_.NextOutput(pending_);
    if (state_.is_finished()) {
      ++num_finishes_;
      return started;
    }
    if (started.output == Output::kAnswer) --pending_.num_answers;
    if (started.output == Output::kNotification) --pending_.num_notifications;
    started.task = state_.NextTask(pending_);
    if (started.task.handles_requests) pending_.num_requests = 0;
    started.read = state_.NextRead(pending_);
    return started;
  }

  Started Receive() {
    state_.ReadEnded();
    ++pending_.num_requests;
    return Advance();
  }
  Started EndInput(const absl::Status& status) {
    state_.ReadEnded();
    state_.EndInput(status);
    return Advance();
  }
  Started EndTask(const absl::Status& status, std::size_t num_answers, std::size_t num_notifications = 0) {
    state_.TaskEnded(status);
    pending_.num_answers += num_answers;
    pending_.num_notifications += num_notifications;
    return Advance();
  }
  Started EndWrite() {
    state_.WriteEnded();
    return Advance();
  }
  Started Wake() {
    state_.Notify();
    return Advance();
  }

  StreamState state_;
  StreamState::Pending pending_;
  std::optional<absl::Status> end_of_input_ = absl::OkStatus();
  int num_finishes_ = 0;
};

TEST_F(StreamStateTest, ReadsBeforeAnythingElse) {
  const Started started = Advance();
  EXPECT_TRUE(started.read);
  EXPECT_FALSE(started.task.is_due());
  EXPECT_EQ(started.output, Output::kNothing);
  EXPECT_FALSE(Advance().read) << "one read at a time";
}

TEST_F(StreamStateTest, WorksOnARequestWhileItReadsTheNext) {
  Advance();
  const Started started = Receive();
  EXPECT_TRUE(started.task.handles_requests);
  EXPECT_FALSE(started.task.takes_notifications);
  EXPECT_TRUE(started.read);
}

TEST_F(StreamStateTest, ReadsThreeRequestsAheadOfTheTask) {
  Advance();
  EXPECT_TRUE(Receive().task.is_due());
  EXPECT_TRUE(Receive().read);
  EXPECT_TRUE(Receive().read);
  const Started full = Receive();
  EXPECT_FALSE(full.read);
  EXPECT_FALSE(full.task.is_due()) << "one task at a time";
  EXPECT_EQ(pending_.num_requests, StreamState::kMaxPendingRequests);
  EXPECT_TRUE(EndTask(absl::OkStatus(), 1).read);
}

TEST_F(StreamStateTest, WritesOneAtATimeAnswersFirst) {
  pending_ = {.num_answers = 2, .num_notifications = 1};
  EXPECT_EQ(Advance().output, Output::kAnswer);
  EXPECT_EQ(Advance().output, Output::kNothing) << "one write is under way";
  EXPECT_EQ(EndWrite().output, Output::kAnswer);
  EXPECT_EQ(EndWrite().output, Output::kNotification);
  EXPECT_EQ(EndWrite().output, Output::kNothing);
}

TEST_F(StreamStateTest, DoesNothingMoreForAClientThatTakesNoAnswers) {
  Advance();
  pending_.num_answers = StreamState::kMaxPendingAnswers + 1;
  EXPECT_EQ(Advance().output, Output::kAnswer);
  EXPECT_FALSE(Receive().task.is_due());
  const Started started = EndWrite();
  EXPECT_EQ(started.output, Output::kAnswer);
  EXPECT_TRUE(started.task.handles_requests);
}

TEST_F(StreamStateTest, TakesNotificationsAfterAWakeAndNotBefore) {
  Advance();
  EXPECT_FALSE(Advance().task.is_due());
  EXPECT_TRUE(Wake().task.takes_notifications);
  EXPECT_FALSE(EndTask(absl::OkStatus(), 0).task.is_due()) << "one wake, one look";
}

TEST_F(StreamStateTest, AWakeDuringATaskCounts) {
  Advance();
  EXPECT_TRUE(Wake().task.takes_notifications);
  EXPECT_FALSE(Wake().task.is_due());
  EXPECT_TRUE(EndTask(absl::OkStatus(), 0).task.takes_notifications);
}

TEST_F(StreamStateTest, TakesNoNotificationsBeforeThoseBeforeAreWritten) {
  Advance();
  pending_.num_notifications = 2;
  EXPECT_EQ(Wake().output, Output::kNotification);
  EXPECT_FALSE(Advance().task.is_due());
  const Started started = EndWrite();
  EXPECT_EQ(started.output, Output::kNotification);
  EXPECT_TRUE(started.task.takes_notifications) << "the last one is being written";
}

TEST_F(StreamStateTest, EndsWithTheInputWhenAllOfItIsHandled) {
  Advance();
  Receive();
  EXPECT_EQ(EndInput(absl::OkStatus()).output, Output::kNothing) << "the task is under way";
  EXPECT_FALSE(state_.has_ended());
  EXPECT_EQ(EndTask(absl::OkStatus(), 0).output, Output::kFinish);
  EXPECT_EQ(state_.end(), absl::OkStatus());
}

TEST_F(StreamStateTest, TheEndOfTheInputMayHaveToWait) {
  end_of_input_ = std::nullopt;
  Advance();
  EndInput(absl::OkStatus());
  EXPECT_FALSE(state_.has_ended());
  EXPECT_TRUE(Wake().task.takes_notifications);
  end_of_input_ = absl::OkStatus();
  EXPECT_EQ(EndTask(absl::OkStatus(), 0, 1).output, Output::kNotification) << "it has to be written before";
  EXPECT_EQ(EndWrite().output, Output::kFinish);
}

TEST_F(StreamStateTest, AnErrorAtTheEndOfTheInputDropsNotifications) {
  end_of_input_ = kFault;
  Advance();
  pending_.num_notifications = 1;
  EXPECT_EQ(EndInput(absl::OkStatus()).output, Output::kFinish);
  EXPECT_EQ(state_.end(), kFault);
}

TEST_F(StreamStateTest, AfterAnUnreadableRequestThoseBeforeAreAnswered) {
  Advance();
  Receive();
  Receive();
  EXPECT_FALSE(EndInput(kFault).read);
  EXPECT_TRUE(EndTask(absl::OkStatus(), 1).task.handles_requests);
  EXPECT_EQ(EndTask(absl::OkStatus(), 1).output, Output::kNothing) << "the first answer is being written";
  EXPECT_EQ(EndWrite().output, Output::kAnswer);
  EXPECT_EQ(EndWrite().output, Output::kFinish);
  EXPECT_EQ(state_.end(), kFault);
}

TEST_F(StreamStateTest, AnErrorOfATaskComesAfterTheAnswersBefore) {
  Advance();
  Receive();
  const Started started = EndTask(kFault, 1, 1);
  EXPECT_EQ(started.output, Output::kAnswer);
  EXPECT_FALSE(started.read);
  EXPECT_FALSE(Wake().task.is_due()) << "nothing new is begun";
  EXPECT_EQ(EndWrite().output, Output::kFinish) << "without the notification";
  EXPECT_EQ(state_.end(), kFault);
}

TEST_F(StreamStateTest, TheLastAnswerGoesWithAnOrderlyEnd) {
  Advance();
  Receive();
  state_.End(absl::OkStatus());
  EXPECT_EQ(EndTask(absl::OkStatus(), 1).output, Output::kFinishWithLastAnswer);
}

TEST_F(StreamStateTest, TheAnswersBeforeTheLastAreWrittenByThemselves) {
  Advance();
  Receive();
  state_.End(absl::OkStatus());
  EXPECT_EQ(EndTask(absl::OkStatus(), 2).output, Output::kAnswer);
  EXPECT_EQ(EndWrite().output, Output::kFinishWithLastAnswer);
}

TEST_F(StreamStateTest, AnInterruptionWritesNothingAndWaitsForTheTask) {
  Advance();
  Receive();
  pending_.num_answers = 1;
  state_.Interrupt(kGone);
  EXPECT_EQ(Advance().output, Output::kNothing) << "a task is under way";
  EXPECT_EQ(EndTask(absl::OkStatus(), 1).output, Output::kFinish);
  EXPECT_EQ(state_.end(), kGone);
}

TEST_F(StreamStateTest, AnInterruptionWaitsForTheWrite) {
  pending_.num_answers = 2;
  EXPECT_EQ(Advance().output, Output::kAnswer);
  state_.Interrupt(kGone);
  EXPECT_EQ(Advance().output, Output::kNothing);
  EXPECT_EQ(EndWrite().output, Output::kFinish) << "without the second answer";
}

TEST_F(StreamStateTest, TheFirstReasonCounts) {
  state_.End(kFault);
  state_.Interrupt(kGone);
  state_.End(absl::OkStatus());
  EXPECT_EQ(Advance().output, Output::kFinish);
  EXPECT_EQ(state_.end(), kFault);
}

TEST_F(StreamStateTest, IsFinishedOnce) {
  Advance();
  state_.End(kFault);
  Advance();
  Advance();
  Wake();
  state_.Interrupt(kGone);
  Advance();
  EXPECT_EQ(num_finishes_, 1);
}

TEST_F(StreamStateTest, DrainingEndsAnIdleStream) {
  Advance();
  state_.Drain();
  EXPECT_EQ(Advance().output, Output::kFinish);
  EXPECT_EQ(wire::ReasonOf(state_.end()), v1::ERROR_REASON_NOT_SERVING);
}

TEST_F(StreamStateTest, DrainingWaitsForWhatCameIn) {
  Advance();
  Receive();
  Receive();
  state_.Drain();
  Advance();
  EXPECT_FALSE(state_.has_ended());
  EXPECT_TRUE(EndTask(absl::OkStatus(), 1).task.handles_requests);
  EndWrite();
  const Started last = EndTask(absl::OkStatus(), 1);
  EXPECT_EQ(last.output, Output::kAnswer) << "what was acknowledged is told";
  EXPECT_EQ(EndWrite().output, Output::kFinish);
  EXPECT_EQ(wire::ReasonOf(state_.end()), v1::ERROR_REASON_NOT_SERVING);
}

// As ResponseStream has it: one request, which came with the call.
TEST_F(StreamStateTest, AStreamOfResponsesAloneNeverReads) {
  end_of_input_ = std::nullopt;
  state_.EndInput(absl::OkStatus());
  const Started first = Wake();
  EXPECT_FALSE(first.read);
  EXPECT_TRUE(first.task.takes_notifications);
  EXPECT_EQ(EndTask(absl::OkStatus(), 0, 1).output, Output::kNotification);
  EXPECT_TRUE(state_.is_writing());
  EXPECT_EQ(EndWrite().output, Output::kNothing);
  end_of_input_ = absl::OkStatus();
  EXPECT_EQ(Advance().output, Output::kFinish);
}

}  // namespace
}  // namespace curvereg::server
