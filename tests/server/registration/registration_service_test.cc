// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/registration_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/base/parallel.h"
#include "tests/server/registration/registration_server.h"
#include "tests/testing/matchers.h"
#include "wire/geometry_conversion.h"
#include "wire/options_conversion.h"
#include "wire/result_conversion.h"

namespace curvereg::server {
namespace {

using testing::CloudOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::InlineRequest;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;
using testing::RegistrationServer;
using testing::SourceScan;
using testing::TargetScan;

MATCHER_P(HasReason, reason, "has the reason " + wire::ReasonName(reason)) {
  *result_listener << testing::StatusOf(arg);
  return wire::ReasonOf(testing::StatusOf(arg)) == reason;
}

// The one field that the error names; empty when it names none or several.
std::string FieldOf(const absl::Status& status) {
  const auto bad_request = wire::BadRequestOf(status);
  if (!bad_request.has_value() || bad_request->field_violations_size() != 1) return "";
  return bad_request->field_violations(0).field();
}

RegistrationResult ResultOf(const absl::StatusOr<v1::RegisterScansResponse>& response) {
  EXPECT_THAT(response, IsOk());
  if (!response.ok()) return {};
  EXPECT_TRUE(response->has_result());
  const auto result = wire::FromWire(response->result());
  EXPECT_THAT(result, IsOk());
  return result.ok() ? *result : RegistrationResult();
}

v1::RegisterScansRequest StoredRequest(const std::string& source, const std::string& target) {
  v1::RegisterScansRequest request;
  request.mutable_source()->set_name(source);
  request.mutable_target()->set_name(target);
  return request;
}

TEST(RegisterScansCallTest, FindsTheKnownTransformLikeTheCore) {
  RegistrationServer server;
  const RegistrationResult result = ResultOf(server.Register(InlineRequest(SourceScan(), TargetScan())));
  EXPECT_TRUE(result.verdict.accepted);
  EXPECT_THAT(result.T_target_source, IsNear(testing::TrueTransform(), 0.05, 0.005));
  const auto direct = RegisterScans(SourceScan(), TargetScan());
  ASSERT_THAT(direct, IsOk());
  EXPECT_THAT(result.T_target_source, IsNear(direct->T_target_source, 1e-9, 1e-9));  // a quaternion between them
  EXPECT_EQ(result.source_digest, direct->source_digest);
  EXPECT_EQ(result.target_digest, direct->target_digest);
  EXPECT_EQ(result.options_digest, direct->options_digest);
  EXPECT_EQ(result.evidence.num_inliers, direct->evidence.num_inliers);
  EXPECT_TRUE(testing::BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
  EXPECT_THAT(server.metrics.Text(), HasSubstr("RegisterScans"));
}

TEST(RegisterScansCallTest, StoredScansGiveTheSameAndArePreparedOnce) {
  RegistrationServer server;
  const std::string source = server.Store(CloudOf(SourceScan()));
  const std::string target = server.Store(CloudOf(TargetScan()));
  const RegistrationResult sent = ResultOf(server.Register(InlineRequest(SourceScan(), TargetScan())));
  for (int i = 0; i < 2; ++i) {
    const RegistrationResult stored = ResultOf(server.Register(StoredRequest(source, target)));
    EXPECT_EQ(stored.T_target_source->matrix(), sent.T_target_source->matrix());
    EXPECT_EQ(stored.options_digest, sent.options_digest);
    EXPECT_EQ(stored.source_digest, sent.source_digest);
    EXPECT_EQ(stored.stage_times.front().stage, "preparation");
    EXPECT_EQ(server.cache.GetStatistics().num_misses, 2U);
  }
  EXPECT_EQ(server.cache.GetStatistics().num_entries, 2U);
  v1::RegisterScansRequest mixed = StoredRequest("", target);
  *mixed.mutable_source()->mutable_inline_scan() = CloudOf(SourceScan());
  EXPECT_EQ(ResultOf(server.Register(mixed)).T_target_source->matrix(), sent.T_target_source->matrix());
  EXPECT_EQ(server.cache.GetStatistics().num_misses, 2U);
  const RegistrationResult itself = ResultOf(server.Register(StoredRequest(source, source)));
  EXPECT_TRUE(itself.verdict.accepted);
  EXPECT_THAT(itself.T_target_source, IsNear(RigidTransform::Identity(), 1e-3, 1e-4));
}

TEST(RegisterScansCallTest, TheNumberOfThreadsChangesNothing) {
  RegistrationServer server;
  v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  request.mutable_options()->set_max_threads(1);
  const RegistrationResult serial = ResultOf(server.Register(request));
  request.mutable_options()->set_max_threads(1000);  // cut to the limit
  const RegistrationResult parallel = ResultOf(server.Register(request));
  EXPECT_EQ(serial.T_target_source->matrix(), parallel.T_target_source->matrix());
  EXPECT_EQ(serial.covariance, parallel.covariance);
}

TEST(RegisterScansCallTest, ASummaryIsSmallAndSaysTheSame) {
  RegistrationServer server;
  v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  request.set_view(v1::RESULT_VIEW_SUMMARY);
  const auto response = server.Register(request);
  ASSERT_THAT(response, IsOk());
  ASSERT_TRUE(response->has_summary());
  EXPECT_TRUE(response->summary().accepted());
  EXPECT_LE(response->summary().ByteSizeLong(), 200U);
  ASSERT_EQ(response->summary().translation_size(), 3);
  EXPECT_NEAR(response->summary().translation(0), testing::TrueTransform().translation().x(), 0.05);
}

TEST(RegisterScansCallTest, EveryMethodAnswers) {
  RegistrationServer server;
  for (const Method method : AllMethods()) {
    v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
    request.mutable_options()->set_method(wire::ToWire(method));
    request.mutable_options()->set_seed(7);
    request.mutable_options()->mutable_time_budget()->set_seconds(1);
    if (!IsAvailable(method)) {
      EXPECT_THAT(server.Register(request), HasReason(v1::ERROR_REASON_METHOD_UNAVAILABLE)) << MethodName(method);
      continue;
    }
    const RegistrationResult result = ResultOf(server.Register(request));
    EXPECT_EQ(result.seed, 7U) << MethodName(method);
    EXPECT_EQ(result.evidence.num_source_points, static_cast<int64_t>(SourceScan().points.size()));
  }
}

TEST(RegisterScansCallTest, APriorIsHeeded) {
  RegistrationServer server;
  v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  request.mutable_options()->set_method(v1::METHOD_ICP);
  *request.mutable_options()->mutable_prior()->mutable_t_target_source() = wire::ToWire(testing::TrueTransform());
  const RegistrationResult result = ResultOf(server.Register(request));
  EXPECT_TRUE(result.verdict.accepted);
  EXPECT_THAT(result.T_target_source, IsNear(testing::TrueTransform(), 0.05, 0.005));
}

TEST(RegisterScansCallTest, WrongFieldsAreNamed) {
  RegistrationServer server;
  using Change = std::function<void(v1::RegisterScansRequest&)>;
  const std::vector<std::pair<std::string, Change>> cases = {
      {"source", [](auto& request) { request.clear_source(); }},
      {"target", [](auto& request) { request.mutable_target()->clear_inline_scan(); }},
      {"source.name", [](auto& request) { request.mutable_source()->set_name("scans/../etc/passwd"); }},
      {"target.name", [](auto& request) { request.mutable_target()->set_name(""); }},
      {"view", [](auto& request) { request.set_view(static_cast<v1::ResultView>(99)); }},
      {"options.method", [](auto& request) { request.mutable_options()->set_method(static_cast<v1::Method>(99)); }},
      {"options.time_budget", [](auto& request) { request.mutable_options()->mutable_time_budget()->set_seconds(0); }},
      {"options.prior.t_target_source", [](auto& request) { request.mutable_options()->mutable_prior(); }},
      {"source.inline_scan.header.encoding",
       [](auto& request) { request.mutable_source()->mutable_inline_scan()->mutable_header()->clear_encoding(); }},
      {"target.inline_scan.header.gravity", [](auto& request) {
         request.mutable_target()->mutable_inline_scan()->mutable_header()->mutable_gravity()->set_x(
             std::numeric_limits<double>::quiet_NaN());
       }}};
  for (const auto& [field, change] : cases) {
    v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
    change(request);
    const auto response = server.Register(request);
    EXPECT_THAT(response, HasReason(v1::ERROR_REASON_INVALID_FIELD)) << field;
    EXPECT_THAT(FieldOf(response.status()), ::testing::StartsWith(field));
    EXPECT_TRUE(absl::IsInvalidArgument(response.status()));
  }
  EXPECT_EQ(server.pool.Statistics().mean_task_seconds, 0.0);  // none came as far as a worker
}

TEST(RegisterScansCallTest, ScansThatAreNotThereAreNotFound) {
  const std::string name = "scans/0123456789abcdef0123456789abcdef";
  RegistrationServer server;
  EXPECT_THAT(server.Register(StoredRequest(name, name)), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
  RegistrationServer without_store({.has_store = false});
  EXPECT_THAT(without_store.Register(StoredRequest(name, name)), HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND));
}

TEST(RegisterScansCallTest, UnusableScansAreNamed) {
  RegistrationServer server;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scan nothing, line, huge;
  nothing.points.assign(500, Eigen::Vector3f(nan, 0.0F, std::numeric_limits<float>::infinity()));
  for (int i = 0; i < 500; ++i) line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  huge = SourceScan();
  huge.points[1] = {1e30F, 0.0F, 0.0F};
  const std::string stored = server.Store(CloudOf(line));
  for (const Scan& bad : {nothing, line, huge}) {
    for (const v1::Method method : {v1::METHOD_CURVELET, v1::METHOD_PAPER, v1::METHOD_ICP}) {
      v1::RegisterScansRequest request = InlineRequest(SourceScan(), bad);
      request.mutable_options()->set_method(method);
      const auto response = server.Register(request);
      EXPECT_THAT(response, HasReason(v1::ERROR_REASON_UNUSABLE_SCAN));
      EXPECT_EQ(FieldOf(response.status()), "target") << response.status();
    }
  }
  v1::RegisterScansRequest request = StoredRequest(stored, "");
  *request.mutable_target()->mutable_inline_scan() = CloudOf(TargetScan());
  const auto response = server.Register(request);
  EXPECT_THAT(response, HasReason(v1::ERROR_REASON_UNUSABLE_SCAN));
  EXPECT_EQ(FieldOf(response.status()), "source");
}

TEST(RegisterScansCallTest, SomePointsWithoutReturnAreNoMatter) {
  RegistrationServer server;
  Scan gappy = SourceScan();
  for (size_t i = 0; i < gappy.points.size(); i += 10) {
    gappy.points[i].y() = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_TRUE(ResultOf(server.Register(InlineRequest(gappy, TargetScan()))).verdict.accepted);
}

TEST(RegisterScansCallTest, BytesThatDoNotDecodeAreDataLoss) {
  RegistrationServer server;
  v1::RegisterScansRequest request = InlineRequest(SourceScan(), TargetScan());
  v1::PointCloud& cloud = *request.mutable_source()->mutable_inline_scan();
  cloud = *wire::EncodeScan(SourceScan(), {.encoding = v1::POINT_ENCODING_SHUFFLED_ZSTD});
  EXPECT_TRUE(ResultOf(server.Register(request)).verdict.accepted);
  cloud.mutable_data()->resize(cloud.data().size() / 2);
  EXPECT_THAT(server.Register(request), HasReason(v1::ERROR_REASON_MALFORMED_PAYLOAD));
  EXPECT_TRUE(testing::BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

TEST(ListMethodsTest, TellsMethodsOptionsAndLimits) {
  RegistrationServer server;
  grpc::ClientContext context;
  v1::ListMethodsResponse response;
  ASSERT_TRUE(server.stub->ListMethods(&context, {}, &response).ok());
  ASSERT_EQ(response.methods_size(), static_cast<int>(AllMethods().size()));
  EXPECT_EQ(response.methods(0).method(), v1::METHOD_CURVELET);
  for (const v1::MethodInfo& info : response.methods()) {
    const auto method = MethodFromName(info.name());
    ASSERT_TRUE(method.has_value()) << info.name();
    EXPECT_EQ(info.available(), IsAvailable(*method));
    EXPECT_FALSE(info.description().empty());
    for (const v1::MethodOption& option : info.options()) {
      // A field of RegistrationOptions, by its path.
      const google::protobuf::Descriptor* message = v1::RegistrationOptions::descriptor();
      const std::string first = option.name().substr(0, option.name().find('.'));
      EXPECT_NE(message->FindFieldByName(first), nullptr) << option.name();
      EXPECT_FALSE(option.description().empty());
    }
  }
  EXPECT_EQ(response.limits().max_scan_points(), LimitsConfig().max_scan_points);
  EXPECT_EQ(response.limits().max_threads(), 2U);
  EXPECT_EQ(response.limits().max_concurrent_registrations(), 1U);
  EXPECT_EQ(response.limits().max_stored_bytes(), LimitsConfig().max_stored_bytes);
  EXPECT_EQ(response.limits().max_scans_per_traverse(), static_cast<uint32_t>(LimitsConfig().max_scans_per_traverse));
  EXPECT_EQ(response.build_id(), BuildId());
}

}  // namespace
}  // namespace curvereg::server
