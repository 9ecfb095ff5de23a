// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/retry.h"

#include <algorithm>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "wire/error.h"
#include "wire/status_mapping.h"

namespace curvereg::internal {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// RetryInfo's limit; no call waits as long.
constexpr milliseconds kNeverAgain(int64_t{365} * 24 * 3600 * 1000);

std::optional<milliseconds> PushbackOf(const grpc::ClientContext& context) {
  const auto& trailers = context.GetServerTrailingMetadata();
  const auto found = trailers.find("grpc-retry-pushback-ms");
  if (found == trailers.end()) return std::nullopt;
  int64_t value = 0;
  // A value that is no number means "do not come back" (gRPC's A6).
  const bool is_number = absl::SimpleAtoi(std::string(found->second.data(), found->second.size()), &value);
  return is_number && value >= 0 ? std::min(milliseconds(value), kNeverAgain) : kNeverAgain;
}

// gRPC's own, of a server that is short of memory: it resets a stream with HTTP/2's ENHANCE_YOUR_CALM. Only the text
// tells this from a message that is too large, which would be so again.
bool IsMemoryPressure(const absl::Status& error) {
  return error.code() == absl::StatusCode::kResourceExhausted && !wire::ErrorInfoOf(error).has_value() &&
         absl::EndsWith(error.message(), "RST_STREAM with error code 11");
}

RetryOptions RetriesOf(const Connection& connection, bool without_end) {
  RetryOptions options = connection.options().retry;
  if (without_end) options.max_attempts = std::numeric_limits<int>::max();
  return options;
}

}  // namespace

absl::Status CallError(const grpc::Status& status, const grpc::ClientContext& context) {
  absl::Status error = wire::FromGrpcStatus(status);
  if (error.ok()) return error;
  const std::optional<milliseconds> pushback = PushbackOf(context);
  const bool is_final = pushback == kNeverAgain;
  if (pushback && (is_final || !wire::RetryDelayOf(error))) return wire::WithRetryDelay(error, *pushback);
  return error;
}

bool IsRetryable(const absl::Status& error) {
  if (error.code() == absl::StatusCode::kUnavailable) return true;
  // A call that reaches a server at its very end is cancelled by gRPC, before any code of ours could give a reason.
  // When it was the caller who cancelled, the wait before the next attempt ends at once.
  if (absl::IsCancelled(error) && !wire::ErrorInfoOf(error).has_value()) return true;
  if (IsMemoryPressure(error)) return true;
  return error.code() == absl::StatusCode::kResourceExhausted && wire::RetryDelayOf(error).has_value();
}

bool IsResumable(const absl::Status& error) {
  if (IsRetryable(error)) return true;
  const std::optional<v1::ErrorReason> reason = wire::ReasonOf(error);
  if (reason == v1::ERROR_REASON_CHECKSUM_MISMATCH || reason == v1::ERROR_REASON_OFFSET_OUT_OF_RANGE) return true;
  const bool is_broken = error.code() == absl::StatusCode::kInternal || error.code() == absl::StatusCode::kUnknown;
  return is_broken && !wire::ErrorInfoOf(error).has_value();
}

bool IsRefusal(const absl::Status& error) { return wire::ReasonOf(error) == v1::ERROR_REASON_NOT_SERVING; }

std::optional<milliseconds> Backoff::NextDelay(const absl::Status& error, double jitter) {
  if (!IsRefusal(error)) ++num_failures_;
  if (num_failures_ >= options_.max_attempts || options_.max_attempts == 1) return std::nullopt;
  const double factor = 0.8 + 0.4 * jitter;
  const auto drawn = std::chrono::duration_cast<milliseconds>(next_ * factor);
  next_ = std::min(2 * next_, options_.max_backoff);
  const std::optional<milliseconds> asked = wire::RetryDelayOf(error);
  // Spread above the server's delay, or all that it sent away come back in the same instant.
  return asked ? std::max(drawn, *asked + drawn / 4) : drawn;
}

void Backoff::Restart() {
  next_ = options_.initial_backoff;
  num_failures_ = 0;
}

absl::Status SleepFor(milliseconds delay, const Stop& stop) {
  const Clock::time_point end = Clock::now() + delay;
  if (stop.deadline && *stop.deadline < end) return absl::DeadlineExceededError("the next attempt would come too late");
  std::mutex mutex;
  std::condition_variable_any condition;
  std::unique_lock lock(mutex);
  condition.wait_until(lock, stop.cancellation, end, [] { return false; });
  return stop.Cancelled() ? absl::CancelledError("cancelled by the caller") : absl::OkStatus();
}

Retrier::Retrier(Connection& connection, const Options& options)
    : connection_(connection),
      options_(options),
      backoff_(RetriesOf(connection, options.until_timeout)),
      deadline_(Clock::now() + options.timeout) {}

void Retrier::NoteProgress() {
  backoff_.Restart();
  deadline_ = Clock::now() + options_.timeout;
}

absl::Status Retrier::InOurWords(const absl::Status& error) const {
  if (error.ok() || wire::ErrorInfoOf(error).has_value()) return error;
  const std::string server = connection_.target().empty() ? "the server" : connection_.target();
  std::string text;
  if (absl::IsDeadlineExceeded(error)) {
    const double seconds = std::chrono::duration<double>(options_.timeout).count();
    text = absl::StrCat("no answer from ", server, " within ", seconds, " s");
  } else if (absl::IsUnavailable(error)) {
    text = absl::StrCat("lost ", server, ": ", error.message());
  } else if (IsMemoryPressure(error)) {
    text = absl::StrCat(server, " is short of memory: ", error.message());
  } else {
    return error;
  }
  absl::Status ours(error.code(), text);
  error.ForEachPayload([&ours](absl::string_view type, const absl::Cord& payload) { ours.SetPayload(type, payload); });
  return ours;
}

absl::Status Retrier::Run(const std::function<absl::Status(const std::shared_ptr<grpc::Channel>&)>& attempt) {
  absl::Status last;
  while (true) {
    const absl::Status ready = connection_.AwaitReady(Now());
    // What the server said last tells more than "no connection".
    if (!ready.ok()) return last.ok() || absl::IsCancelled(ready) ? ready : InOurWords(last);
    ++num_attempts_;
    last = attempt(connection_.channel());
    if (last.ok() || !options_.may_retry(last)) return InOurWords(last);
    const std::optional<milliseconds> delay = backoff_.NextDelay(last, connection_.Jitter());
    if (!delay) return InOurWords(last);
    const absl::Status slept = SleepFor(*delay, Now());
    if (!slept.ok()) return absl::IsCancelled(slept) ? slept : InOurWords(last);
  }
}

absl::Status CallUnary(Connection& connection, const UnaryAttempt& attempt, const Stop& stop) {
  const Clock::time_point now = Clock::now();
  const Clock::time_point last = now + connection.options().call_timeout;
  const auto timeout = std::chrono::ceil<milliseconds>(std::clamp(stop.deadline.value_or(last), now, last) - now);
  Retrier retrier(connection, {.cancellation = stop.cancellation, .timeout = timeout});
  return retrier.Run([&](const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    connection.Prepare(context);
    const Clock::duration left = *retrier.Now().deadline - Clock::now();
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::duration_cast<std::chrono::system_clock::duration>(left));
    const std::stop_callback cancel(stop.cancellation, [&] { context.TryCancel(); });
    return CallError(attempt(channel, &context), context);
  });
}

absl::Status CallDeletion(Connection& connection, const UnaryAttempt& attempt, const Stop& stop) {
  bool was_lost = false;  // an attempt before the last
  bool is_lost = false;
  const absl::Status status = CallUnary(
      connection,
      [&](const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* context) {
        grpc::Status ended = attempt(channel, context);
        was_lost = was_lost || is_lost;
        is_lost = !ended.ok() && !IsRefusal(wire::FromGrpcStatus(ended));
        return ended;
      },
      stop);
  return absl::IsNotFound(status) && was_lost ? absl::OkStatus() : status;
}

}  // namespace curvereg::internal
