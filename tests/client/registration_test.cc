// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/registration.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/scripted_server.h"
#include "wire/duration.h"
#include "wire/result_conversion.h"

namespace curvereg {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ConnectTo;
using ::testing::ElementsAre;
using testing::QuickOptions;
using testing::Refusal;
using testing::Script;
using testing::ScriptedServer;
using Clock = std::chrono::steady_clock;

// Keeps the time budgets that it is sent [s]; -1 for none.
class BudgetTest : public ::testing::Test {
 protected:
  absl::StatusOr<RegistrationResult> Register(const RegistrationOptions& options) {
    return ConnectTo(server_.target(), client_options_)->RegisterScans(std::string("a"), std::string("b"), options);
  }

  ClientOptions client_options_ = QuickOptions();
  std::vector<double> budgets_;
  std::function<grpc::Status(grpc::ServerContext&)> before_answer_ = [](auto&) { return grpc::Status::OK; };

 private:
  Script MakeScript() {
    Script script;
    script.register_scans = [this](auto& context, const auto& request, auto& response) {
      const auto& options = request.options();
      budgets_.push_back(options.has_time_budget() ? *wire::SecondsOf(options.time_budget()) : -1.0);
      *response.mutable_result() = wire::ToWire(RegistrationResult());
      return before_answer_(context);
    };
    return script;
  }
  const ScriptedServer server_{MakeScript()};
};

TEST_F(BudgetTest, TheLessOfBudgetAndDeadlineTravels) {
  RegistrationOptions options;
  ASSERT_TRUE(Register(options).ok());
  options.deadline = Clock::now() + seconds(100);
  ASSERT_TRUE(Register(options).ok());
  options.time_budget_s = 2.5;
  ASSERT_TRUE(Register(options).ok());
  options.time_budget_s = 1000.0;
  ASSERT_TRUE(Register(options).ok());
  options.deadline = Clock::time_point::max();
  ASSERT_TRUE(Register(options).ok());
  const auto is_rest = ::testing::AllOf(::testing::Gt(80.0), ::testing::Le(100.0));
  EXPECT_THAT(budgets_, ElementsAre(-1.0, is_rest, 2.5, is_rest, 1000.0));
}

TEST_F(BudgetTest, ADeadlineInThePastLeavesTheLeast) {
  RegistrationOptions options;
  for (const Clock::time_point deadline : {Clock::now() - std::chrono::hours(1), Clock::time_point::min()}) {
    options.deadline = deadline;
    ASSERT_TRUE(Register(options).ok());
  }
  EXPECT_THAT(budgets_, ElementsAre(1e-9, 1e-9));
}

TEST_F(BudgetTest, AUselessBudgetStaysOneForTheServerToRefuse) {
  RegistrationOptions options;
  options.deadline = Clock::now() + seconds(100);
  options.time_budget_s = -3.0;
  ASSERT_TRUE(Register(options).ok());
  options.time_budget_s = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(Register(options).ok());
  EXPECT_THAT(budgets_, ElementsAre(-3.0, 0.0));
}

TEST_F(BudgetTest, EachAttemptGetsWhatIsLeft) {
  before_answer_ = [this](auto&) {
    return budgets_.size() < 3 ? Refusal(v1::ERROR_REASON_QUEUE_FULL, milliseconds(200)) : grpc::Status::OK;
  };
  RegistrationOptions options;
  options.deadline = Clock::now() + seconds(100);
  ASSERT_TRUE(Register(options).ok());
  ASSERT_EQ(budgets_.size(), 3U);
  EXPECT_LE(budgets_[1], budgets_[0] - 0.2);
  EXPECT_LE(budgets_[2], budgets_[1] - 0.2);
}

grpc::Status WaitForTheEnd(grpc::ServerContext& context) {
  while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(5));
  return grpc::Status::CANCELLED;
}

TEST_F(BudgetTest, AServerThatIsLateIsNotWaitedFor) {
  before_answer_ = WaitForTheEnd;
  RegistrationOptions options;
  options.seed = 9;
  const Clock::time_point start = Clock::now();
  options.deadline = start + milliseconds(100);
  const auto result = Register(options);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_LT(Clock::now() - start, seconds(8));
  EXPECT_FALSE(result->T_target_source.has_value());
  EXPECT_FALSE(result->verdict.accepted);
  EXPECT_THAT(result->verdict.reasons, ElementsAre(Reason::kDeadline));
  EXPECT_EQ(result->seed, 9U);
}

TEST_F(BudgetTest, ACallTimeoutBeforeTheDeadlineIsAnError) {
  before_answer_ = WaitForTheEnd;
  client_options_.call_timeout = milliseconds(200);
  RegistrationOptions options;
  options.deadline = Clock::now() + seconds(100);
  EXPECT_TRUE(absl::IsDeadlineExceeded(Register(options).status()));
}

}  // namespace
}  // namespace curvereg
