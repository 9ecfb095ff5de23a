// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/server_status.h"

#include <google/protobuf/message.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/retry.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "grpc/health/v1/health.grpc.pb.h"

namespace curvereg::internal {
namespace {

using Clock = std::chrono::steady_clock;
namespace health = grpc::health::v1;

constexpr int kNumRoundTrips = 5;
constexpr const char* kServices[] = {v1::RegistrationService::service_full_name(), v1::ScanService::service_full_name(),
                                     v1::TraverseService::service_full_name()};

// NOT_FOUND: the server does not have this service.
absl::StatusOr<bool> IsServing(Connection& connection, const std::string& service, const Stop& until) {
  health::HealthCheckRequest request;
  request.set_service(service);
  health::HealthCheckResponse response;
  const absl::Status status = CallUnary(
      connection,
      [&](const auto& channel, grpc::ClientContext* context) {
        return health::Health::NewStub(channel)->Check(context, request, &response);
      },
      until);
  if (!status.ok()) return status;
  return response.status() == health::HealthCheckResponse::SERVING;
}

absl::Status CheckHealth(Connection& connection, const Stop& until, ServerStatus& result) {
  std::vector<std::chrono::microseconds> times;
  for (int i = 0; i < kNumRoundTrips; ++i) {
    const Clock::time_point start = Clock::now();
    const absl::StatusOr<bool> serving = IsServing(connection, "", until);
    if (!serving.ok()) return serving.status();
    times.push_back(std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start));
    result.serving = *serving;
  }
  std::sort(times.begin(), times.end());
  result.round_trip = times[times.size() / 2];
  for (const char* service : kServices) {
    const absl::StatusOr<bool> serving = IsServing(connection, service, until);
    if (serving.ok()) result.services.emplace_back(service, *serving);
    if (!serving.ok() && !absl::IsNotFound(serving.status())) return serving.status();
  }
  return absl::OkStatus();
}

// Names and values of a message of unsigned integers.
std::vector<std::pair<std::string, uint64_t>> NumbersOf(const google::protobuf::Message& message) {
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  const google::protobuf::Reflection& values = *message.GetReflection();
  std::vector<std::pair<std::string, uint64_t>> numbers;
  for (int i = 0; i < type.field_count(); ++i) {
    const google::protobuf::FieldDescriptor* field = type.field(i);
    const bool is_short = field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_UINT32;
    numbers.emplace_back(field->name(), is_short ? values.GetUInt32(message, field) : values.GetUInt64(message, field));
  }
  return numbers;
}

void Take(const v1::ListMethodsResponse& response, ServerStatus& result) {
  result.build_id = response.build_id();
  for (const v1::MethodInfo& method : response.methods()) {
    result.methods.push_back({method.name(), method.description(), method.available()});
  }
  result.limits = NumbersOf(response.limits());
  result.load = NumbersOf(response.load());
}

}  // namespace

absl::StatusOr<ServerStatus> FetchServerStatus(Connection& connection, const Stop& until) {
  ServerStatus result;
  if (absl::Status status = CheckHealth(connection, until, result); !status.ok()) return status;
  // A server that is starting or stopping answers for its health and refuses all else: that is its status.
  if (!result.serving) return result;
  v1::ListMethodsResponse response;
  const absl::Status status = CallUnary(
      connection,
      [&](const auto& channel, grpc::ClientContext* context) {
        return v1::RegistrationService::NewStub(channel)->ListMethods(context, v1::ListMethodsRequest(), &response);
      },
      until);
  if (!status.ok()) return status;
  Take(response, result);
  return result;
}

absl::Status ExplainNoConnection(Connection& connection, const absl::Status& fallback) {
  // Fails at once on a channel that could not connect, with the last attempt's error in the message.
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(200));
  health::HealthCheckResponse response;
  const grpc::Status status =
      health::Health::NewStub(connection.channel())->Check(&context, health::HealthCheckRequest(), &response);
  if (status.error_code() != grpc::UNAVAILABLE || status.error_message().empty()) return fallback;
  return absl::UnavailableError(
      absl::StrCat(std::string(fallback.message()), ": ", std::string(status.error_message())));
}

}  // namespace curvereg::internal
