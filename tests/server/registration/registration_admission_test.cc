// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a RegistrationService refuses, drops and stops, and that nothing of it stays behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>
#include <thread>

#include "server/registration/register_call.h"
#include "tests/server/registration/registration_server.h"
#include "tests/server/scheduling/busy_worker.h"
#include "tests/testing/matchers.h"

namespace curvereg::server {
namespace {

using testing::BecomesTrue;
using testing::BusyWorker;
using testing::CloudOf;
using ::testing::HasSubstr;
using testing::InlineRequest;
using testing::IsOk;
using testing::RegistrationServer;
using testing::SourceScan;
using testing::StrangeScan;
using testing::TargetScan;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

MATCHER_P(HasReason, reason, "has the reason " + wire::ReasonName(reason)) {
  *result_listener << testing::StatusOf(arg);
  return wire::ReasonOf(testing::StatusOf(arg)) == reason;
}

bool IsMarkedLate(const absl::StatusOr<v1::RegisterScansResponse>& response) {
  if (!response.ok() || response->result().verdict().accepted()) return false;
  for (const int reason : response->result().verdict().reasons()) {
    if (reason == v1::VERDICT_REASON_DEADLINE) return true;
  }
  return false;
}

// How long the registration that no deadline bounds takes.
milliseconds WholeTime() {
  static const milliseconds whole = [] {
    const Clock::time_point start = Clock::now();
    RegistrationOptions options;
    options.num_threads = 2;
    EXPECT_THAT(RegisterScans(StrangeScan(), TargetScan(), options), IsOk());
    return std::chrono::duration_cast<milliseconds>(Clock::now() - start);
  }();
  return whole;
}

void SetDeadline(grpc::ClientContext& context, milliseconds timeout) {
  context.set_deadline(std::chrono::system_clock::now() + timeout);
}

TEST(RegistrationAdmissionTest, AFullQueueRefusesAndTellsWhenToComeBack) {
  RegistrationServer server(
      {.limits = {.max_queue_length = 1, .max_concurrent_registrations = 1, .max_threads_per_registration = 2}});
  BusyWorker busy(server.pool);
  const v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  std::jthread waiting([&] { EXPECT_THAT(server.Register(request), IsOk()); });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 1; }));
  grpc::ClientContext context;
  const auto refused = server.Register(request, context);
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_QUEUE_FULL));
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  const auto delay = wire::RetryDelayOf(refused.status());
  ASSERT_TRUE(delay.has_value());
  const auto pushback = context.GetServerTrailingMetadata().find("grpc-retry-pushback-ms");
  ASSERT_NE(pushback, context.GetServerTrailingMetadata().end());
  EXPECT_EQ(std::string(pushback->second.data(), pushback->second.size()), std::to_string(delay->count()));
  busy.LetGo();
}

TEST(RegistrationAdmissionTest, OneClientGetsItsShareOnly) {
  RegistrationServer server(
      {.limits = {.max_queue_per_client = 1, .max_concurrent_registrations = 1, .max_threads_per_registration = 2}});
  BusyWorker busy(server.pool);
  const v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  std::jthread waiting([&] { EXPECT_THAT(server.Register(request), IsOk()); });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 1; }));
  EXPECT_THAT(server.Register(request), HasReason(v1::ERROR_REASON_CLIENT_QUOTA));
  busy.LetGo();
}

TEST(RegistrationAdmissionTest, ListMethodsTellsTheLoad) {
  RegistrationServer server;
  server.Store(CloudOf(SourceScan()));
  const auto load = [&] {
    grpc::ClientContext context;
    v1::ListMethodsResponse response;
    EXPECT_TRUE(server.stub->ListMethods(&context, {}, &response).ok());
    return response.load();
  };
  EXPECT_EQ(load().registrations_running(), 0U);
  EXPECT_EQ(load().registrations_waiting(), 0U);
  EXPECT_EQ(load().scans(), 1U);
  EXPECT_GE(load().stored_bytes(), SourceScan().points.size() * 12);
  BusyWorker busy(server.pool);
  std::jthread waiting([&] { EXPECT_THAT(server.Register(InlineRequest(SourceScan(), TargetScan())), IsOk()); });
  ASSERT_TRUE(BecomesTrue([&] { return load().registrations_waiting() == 1; }));
  EXPECT_EQ(load().registrations_running(), 1U);
  EXPECT_GT(load().memory_reserved_bytes(), 0U);
  busy.LetGo();
}

TEST(RegistrationAdmissionTest, MemoryIsReservedBeforeTheQueueAndLittleForPreparedScans) {
  RegistrationServer server({.memory_bytes = uint64_t{400} << 20});
  v1::RegisterScansRequest stored;
  stored.mutable_source()->set_name(server.Store(CloudOf(SourceScan())));
  stored.mutable_target()->set_name(server.Store(CloudOf(TargetScan())));
  ASSERT_THAT(server.Register(stored), IsOk());
  ASSERT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
  const auto others = server.memory.Reserve(uint64_t{340} << 20);
  ASSERT_THAT(others, IsOk());
  BusyWorker busy(server.pool);
  const auto refused = server.Register(InlineRequest(SourceScan(), TargetScan()));  // while no worker is free
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_MEMORY_BUDGET));
  EXPECT_TRUE(wire::RetryDelayOf(refused.status()).has_value());
  busy.LetGo();
  EXPECT_THAT(server.Register(stored), IsOk());
}

TEST(RegistrationAdmissionTest, ScansBeyondTheLimitsAreTooLarge) {
  RegistrationServer few_points(
      {.limits = {.max_scan_points = 1000, .max_concurrent_registrations = 1, .max_threads_per_registration = 1}});
  EXPECT_THAT(few_points.Register(InlineRequest(SourceScan(), TargetScan())),
              HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  EXPECT_THAT(few_points.metrics.Text(), HasSubstr("curvereg_rejected_total{reason=\"SCAN_TOO_LARGE\"} 1"));
  RegistrationServer little_memory({.memory_bytes = uint64_t{30} << 20});
  EXPECT_THAT(little_memory.Register(InlineRequest(SourceScan(), TargetScan())),
              HasReason(v1::ERROR_REASON_SCAN_TOO_LARGE));
  RegistrationServer short_messages(
      {.limits = {.max_message_bytes = 10'000, .max_concurrent_registrations = 1, .max_threads_per_registration = 1}});
  EXPECT_TRUE(absl::IsResourceExhausted(short_messages.Register(InlineRequest(SourceScan(), TargetScan())).status()));
}

TEST(RegistrationAdmissionTest, ACallCancelledWhileItWaitsLeavesAtOnce) {
  RegistrationServer server;
  BusyWorker busy(server.pool);
  grpc::ClientContext context;
  std::jthread waiting([&] {
    EXPECT_TRUE(absl::IsCancelled(server.Register(InlineRequest(SourceScan(), TargetScan()), context).status()));
  });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 1; }));
  EXPECT_GT(server.memory.reserved_bytes(), 0U);
  context.TryCancel();
  EXPECT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 0; }));
  EXPECT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));  // while the worker is busy still
}

TEST(RegistrationAdmissionTest, CancellingARunningCallStopsTheWork) {
  RegistrationServer server;
  const milliseconds whole = WholeTime();
  grpc::ClientContext context;
  std::jthread waiting([&] {
    EXPECT_TRUE(absl::IsCancelled(server.Register(InlineRequest(StrangeScan(), TargetScan()), context).status()));
  });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_running == 1; }));
  const Clock::time_point start = Clock::now();
  context.TryCancel();
  EXPECT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_running == 0; }));
  EXPECT_LT(Clock::now() - start, std::max(whole / 2, milliseconds(100)));
  EXPECT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

TEST(RegistrationAdmissionTest, ADeadlineIsAnsweredByWhatThereIs) {
  // Many points of two worlds on one thread: takes seconds.
  const testing::ScannerOptions scanner = {.num_columns = 2880, .num_rows = 192, .world_seed = 2};
  const Scan source = testing::BumpyGround(testing::RoverPose(1.0, 2.0, 0.5, 1.6, 2), scanner);
  const Scan target = testing::BumpyGround(testing::RoverPose(0.0, 0.0, 0.0), {.num_columns = 2880, .num_rows = 192});
  v1::RegisterScansRequest request = InlineRequest(source, target);
  request.mutable_options()->set_max_threads(1);
  RegistrationServer server;
  const Clock::time_point start = Clock::now();
  const auto whole = server.Register(request);
  const auto whole_time = std::chrono::duration_cast<milliseconds>(Clock::now() - start);
  ASSERT_THAT(whole, IsOk());
  if (whole_time < milliseconds(600)) GTEST_SKIP() << "this machine is too fast for the scans of this test";
  grpc::ClientContext context;
  SetDeadline(context, whole_time * 6 / 10);
  const auto response = server.Register(request, context);
  ASSERT_THAT(response, IsOk());
  EXPECT_TRUE(IsMarkedLate(response)) << response->ShortDebugString();
  EXPECT_LT(response->result().evidence().attempt_count(), whole->result().evidence().attempt_count());
  // The deadline of the call is no part of what was asked.
  EXPECT_EQ(response->result().options_digest(), whole->result().options_digest());
}

TEST(RegistrationAdmissionTest, ATimeBudgetIsAnsweredByWhatThereIs) {
  RegistrationServer server;
  v1::RegisterScansRequest sent = InlineRequest(StrangeScan(), TargetScan());
  sent.mutable_options()->mutable_time_budget()->set_nanos(1);
  EXPECT_TRUE(IsMarkedLate(server.Register(sent)));
  v1::RegisterScansRequest stored = sent;
  stored.mutable_source()->set_name(server.Store(CloudOf(StrangeScan())));
  const auto late = server.Register(stored);
  EXPECT_TRUE(IsMarkedLate(late));
  EXPECT_FALSE(late->result().has_t_target_source());
  EXPECT_EQ(late->result().options_digest().size(), 16U);
  EXPECT_EQ(late->result().build_id(), BuildId());
}

TEST(RegistrationAdmissionTest, ADeadlineThatPassesInTheQueueIsTold) {
  RegistrationServer server;
  BusyWorker busy(server.pool);
  grpc::ClientContext context;
  SetDeadline(context, milliseconds(100));
  const auto response = server.Register(InlineRequest(SourceScan(), TargetScan()), context);
  EXPECT_TRUE(absl::IsDeadlineExceeded(response.status())) << response.status();
  EXPECT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 0; }));
  EXPECT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

TEST(RegistrationAdmissionTest, TheAnswerIsMadeATenthBeforeTheDeadline) {
  const Clock::time_point now = Clock::now();
  using std::chrono::seconds;
  EXPECT_EQ(AnswerBy(now, now + seconds(5)), now + milliseconds(4500));
  EXPECT_EQ(AnswerBy(now, now + seconds(60)), now + seconds(59));
  EXPECT_EQ(AnswerBy(now, now + milliseconds(100)), now + milliseconds(50));
}

TEST(RegistrationAdmissionTest, ADrainingServerRefuses) {
  RegistrationServer server;
  server.draining.request_stop();
  EXPECT_THAT(server.Register(InlineRequest(SourceScan(), TargetScan())), HasReason(v1::ERROR_REASON_NOT_SERVING));
  EXPECT_THAT(server.Render({}), HasReason(v1::ERROR_REASON_NOT_SERVING));
  grpc::ClientContext context;
  v1::ListMethodsResponse methods;
  EXPECT_EQ(server.stub->ListMethods(&context, {}, &methods).error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST(RegistrationAdmissionTest, TheServersEndStopsCallsThatWaitAndCallsThatRun) {
  RegistrationServer server;
  const auto call = [&server](const Scan& source, const Scan& target) {
    EXPECT_THAT(server.Register(InlineRequest(source, target)), HasReason(v1::ERROR_REASON_NOT_SERVING));
  };
  std::jthread running([&] { call(StrangeScan(), TargetScan()); });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_running == 1; }));
  std::jthread waiting([&] { call(SourceScan(), TargetScan()); });
  ASSERT_TRUE(BecomesTrue([&] { return server.pool.Statistics().num_waiting == 1; }));
  server.ending.request_stop();
  running.join();
  waiting.join();
  EXPECT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

TEST(RegistrationAdmissionTest, AStoppedPoolRefuses) {
  RegistrationServer server;
  server.pool.Shutdown(Clock::now());
  EXPECT_THAT(server.Register(InlineRequest(SourceScan(), TargetScan())), HasReason(v1::ERROR_REASON_NOT_SERVING));
}

// Tokens without a scope.
class NoScope final : public Access {
 public:
  absl::StatusOr<std::string> Check(std::string_view, Scope) const override {
    return wire::MakeError(v1::ERROR_REASON_SCOPE_MISSING, "no", {{"scope", "read"}});
  }
};

TEST(RegistrationAdmissionTest, ScopesAreAskedFor) {
  const NoScope access;
  RegistrationServer server({.access = &access});
  EXPECT_THAT(server.Register(InlineRequest(SourceScan(), TargetScan())), HasReason(v1::ERROR_REASON_SCOPE_MISSING));
  EXPECT_THAT(server.Render({}), HasReason(v1::ERROR_REASON_SCOPE_MISSING));
}

TEST(RegistrationAdmissionTest, ManyCallsAtOnceAllEnd) {
  RegistrationServer server({.limits = {.max_queue_length = 4,
                                        .max_queue_per_client = 4,
                                        .max_concurrent_registrations = 2,
                                        .max_threads_per_registration = 1}});
  const v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  std::atomic<int> num_ok = 0, num_refused = 0, num_cancelled = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 12; ++t) {
      threads.emplace_back([&, t] {
        grpc::ClientContext context;
        std::jthread canceller;
        if (t % 3 == 0) {
          canceller = std::jthread([&context, t] {
            std::this_thread::sleep_for(milliseconds(3 * t));
            context.TryCancel();
          });
        }
        const auto response = server.Register(request, context);
        num_ok += response.ok() ? 1 : 0;
        num_refused += absl::IsResourceExhausted(response.status()) ? 1 : 0;
        num_cancelled += absl::IsCancelled(response.status()) ? 1 : 0;
      });
    }
  }
  EXPECT_EQ(num_ok + num_refused + num_cancelled, 12);
  EXPECT_GT(num_ok, 0);
  EXPECT_TRUE(BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

}  // namespace
}  // namespace curvereg::server
