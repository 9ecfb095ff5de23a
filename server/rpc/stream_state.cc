// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/stream_state.h"

#include "wire/error.h"

namespace curvereg::server {

void StreamState::EndInput(const absl::Status& status) { input_end_ = status; }

void StreamState::TaskEnded(const absl::Status& status) {
  is_working_ = false;
  if (!status.ok()) End(status);
}

void StreamState::End(const absl::Status& status) {
  if (!end_.has_value()) end_ = status;
}

void StreamState::Interrupt(const absl::Status& status) {
  End(status);
  is_interrupted_ = true;
}

void StreamState::EndIfIdle(const Pending& pending, const std::function<std::optional<absl::Status>()>& end_of_input) {
  if (is_working_ || pending.num_requests > 0) return;
  if (input_end_.has_value()) {
    const std::optional<absl::Status> end = input_end_->ok() ? end_of_input() : input_end_;
    if (end.has_value() && (!end->ok() || pending.num_notifications == 0)) End(*end);
  }
  if (is_draining_) {
    End(wire::MakeError(v1::ERROR_REASON_NOT_SERVING, "the server is about to stop; what was acknowledged stays"));
  }
}

StreamState::Output StreamState::NextOutput(const Pending& pending) {
  const bool has_answers = !is_interrupted_ && pending.num_answers > 0;
  if (end_.has_value() && !is_working_ && !is_writing_) {
    const bool is_last_answer = end_->ok() && pending.num_answers == 1;
    is_finished_ = !has_answers || is_last_answer;
    if (is_finished_) return has_answers ? Output::kFinishWithLastAnswer : Output::kFinish;
  }
  if (is_writing_ || is_interrupted_) return Output::kNothing;
  is_writing_ = true;
  if (has_answers) return Output::kAnswer;
  // Answers are written even when the call ends with an error. Notifications can be asked for again in another call.
  if (!end_.has_value() && pending.num_notifications > 0) return Output::kNotification;
  is_writing_ = false;
  return Output::kNothing;
}

StreamState::Task StreamState::NextTask(const Pending& pending) {
  Task task;
  if (end_.has_value() || is_working_) return task;
  task.handles_requests = pending.num_requests > 0 && pending.num_answers < kMaxPendingAnswers;
  task.takes_notifications = notifications_due_ && pending.num_notifications == 0;
  if (task.takes_notifications) notifications_due_ = false;
  is_working_ = task.is_due();
  return task;
}

bool StreamState::NextRead(const Pending& pending) {
  if (end_.has_value() || is_reading_ || input_end_.has_value()) return false;
  is_reading_ = pending.num_requests < kMaxPendingRequests;
  return is_reading_;
}

}  // namespace curvereg::server
