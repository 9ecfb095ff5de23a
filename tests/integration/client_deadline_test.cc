// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A deadline in a client's options means over the wire what it means in the core.
#include <chrono>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::Contains;
using testing::IsOk;
using Clock = std::chrono::steady_clock;

class ClientDeadlineTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(server_.port(), 0);
    ASSERT_THAT(client_, IsOk());
  }
  absl::StatusOr<RegistrationResult> Register(const RegistrationOptions& options) {
    return (*client_)->RegisterScans(std::cref(pair_.source), std::cref(pair_.target), options);
  }

  const testing::ScanPairWithTruth pair_ = testing::PairOf("mars-yard-sim", 1, 0);
  const testing::TemporaryFolder folder_;
  const testing::ServerProcess server_{CURVEREG_SERVER_EXECUTABLE, folder_.path(), {}};
  const absl::StatusOr<std::unique_ptr<Client>> client_ = Client::Connect(server_.target());
};

TEST_F(ClientDeadlineTest, ARegistrationEndsAtIt) {
  const testing::ScanPairWithTruth negatives = testing::PairOf("negatives", 1, 0);  // nothing fits: takes longest
  const auto register_negatives = [&](const RegistrationOptions& options) {
    return (*client_)->RegisterScans(std::cref(negatives.source), std::cref(negatives.target), options);
  };
  RegistrationOptions options;
  options.num_threads = 1;
  Clock::time_point start = Clock::now();
  ASSERT_THAT(register_negatives(options), IsOk());
  const Clock::duration whole = Clock::now() - start;
  start = Clock::now();
  options.deadline = start + whole / 3;
  const auto late = register_negatives(options);
  const Clock::duration took = Clock::now() - start;
  ASSERT_THAT(late, IsOk());
  EXPECT_THAT(late->verdict.reasons, Contains(Reason::kDeadline));
  EXPECT_FALSE(late->verdict.accepted);
  EXPECT_LT(took, whole * 8 / 10);
}

TEST_F(ClientDeadlineTest, OneInThePastIsAnsweredAsByTheCore) {
  for (const Method method : {Method::kCurvelet, Method::kPaper}) {
    RegistrationOptions options;
    options.method = method;
    options.deadline = Clock::now() - std::chrono::seconds(1);
    const auto remote = Register(options);
    const auto local = RegisterScans(pair_.source, pair_.target, options);
    ASSERT_THAT(remote, IsOk());
    ASSERT_THAT(local, IsOk());
    EXPECT_EQ(remote->verdict.reasons, local->verdict.reasons) << MethodName(method);
    EXPECT_EQ(remote->verdict.accepted, local->verdict.accepted);
    EXPECT_EQ(remote->T_target_source.has_value(), local->T_target_source.has_value());
    EXPECT_EQ(remote->T_target_source.value_or(RigidTransform::Identity()).matrix(),
              local->T_target_source.value_or(RigidTransform::Identity()).matrix());
    EXPECT_EQ(remote->evidence.num_source_points, local->evidence.num_source_points);
    EXPECT_EQ(remote->source_digest, local->source_digest);
    EXPECT_EQ(remote->seed, local->seed);
  }
}

TEST_F(ClientDeadlineTest, OneThatIsFarChangesNothing) {
  RegistrationOptions options;
  const auto free = Register(options);
  options.deadline = Clock::now() + std::chrono::hours(1);
  const auto bound = Register(options);
  ASSERT_THAT(free, IsOk());
  ASSERT_THAT(bound, IsOk());
  EXPECT_EQ(bound->T_target_source->matrix(), free->T_target_source->matrix());
  EXPECT_EQ(bound->verdict.accepted, free->verdict.accepted);
}

}  // namespace
}  // namespace curvereg
