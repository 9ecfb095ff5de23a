// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking/optimization_requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "tests/server/store/store_testing.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using testing::IsOk;

std::shared_ptr<OptimizationRequest> RequestOf(const std::string& client, const Stop& stop = {}) {
  return std::make_shared<OptimizationRequest>(v1::OptimizeTraverseRequest(), client, stop, [](const auto&) {});
}

TEST(OptimizationRequestsTest, TheFirstIsTheFirstToGo) {
  OptimizationRequests requests;
  EXPECT_TRUE(requests.empty());
  for (const char* client : {"a", "b", "c"}) ASSERT_THAT(requests.Add(RequestOf(client)), IsOk());
  EXPECT_EQ(requests.TakeNext()->client(), "a");
  const auto rest = requests.TakeAll();
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[0]->client(), "b");
  EXPECT_EQ(rest[1]->client(), "c");
  EXPECT_TRUE(requests.empty());
}

TEST(OptimizationRequestsTest, SixteenMayWait) {
  OptimizationRequests requests;
  for (int i = 0; i < 16; ++i) ASSERT_THAT(requests.Add(RequestOf("client")), IsOk());
  const absl::Status refused = requests.Add(RequestOf("client"));
  EXPECT_THAT(refused, HasReason(v1::ERROR_REASON_QUEUE_FULL));
  EXPECT_EQ(wire::RetryDelayOf(refused), std::chrono::milliseconds(1000));
  requests.TakeNext();
  EXPECT_THAT(requests.Add(RequestOf("client")), IsOk());
}

TEST(OptimizationRequestTest, StopsWithItsCaller) {
  std::stop_source caller, closing;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::hours(1);
  const auto request = RequestOf("client", {caller.get_token(), deadline});
  request->StopWith(caller.get_token(), closing.get_token());
  EXPECT_FALSE(request->stop().Requested());
  EXPECT_EQ(request->stop().deadline, deadline);
  caller.request_stop();
  EXPECT_TRUE(request->stop().Requested());
}

TEST(OptimizationRequestTest, StopsWhenTheTraverseIsClosed) {
  std::stop_source caller, closing;
  const auto request = RequestOf("client", {caller.get_token(), {}});
  request->StopWith(caller.get_token(), closing.get_token());
  closing.request_stop();
  EXPECT_TRUE(request->stop().Requested());
}

TEST(OptimizationRequestTest, TellsItsEnd) {
  std::vector<absl::StatusOr<v1::OptimizeTraverseResponse>> answers;
  const OptimizationRequest request({}, "client", {}, [&](const auto& answer) { answers.push_back(answer); });
  v1::OptimizeTraverseResponse response;
  response.set_version(5);
  request.Finish(response);
  ASSERT_EQ(answers.size(), 1U);
  ASSERT_THAT(answers[0], IsOk());
  EXPECT_EQ(answers[0]->version(), 5U);
}

}  // namespace
}  // namespace curvereg::server
