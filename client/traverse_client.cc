// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_client.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/retry.h"
#include "client/traverse_conversion.h"
#include "client/traverse_map.h"
#include "client/traverse_streamer.h"
#include "client/traverse_watch.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg::internal {
namespace {

constexpr int kPageSize = 1000;
// A trajectory whose version changes from page to page is read again, so often at most.
constexpr int kMaxReadings = 10;

// A unary method of the service by its stub's member function.
template <typename Request, typename Response>
using Method = grpc::Status (v1::TraverseService::Stub::*)(grpc::ClientContext*, const Request&, Response*);

template <typename Request, typename Response>
absl::StatusOr<Response> Call(Connection& connection, Method<Request, Response> method, const Request& request,
                              const Stop& until) {
  Response response;
  const absl::Status status = CallUnary(
      connection,
      [&](const auto& channel, grpc::ClientContext* context) {
        response.Clear();
        return (v1::TraverseService::NewStub(channel).get()->*method)(context, request, &response);
      },
      until);
  if (!status.ok()) return status;
  return response;
}

class ConnectedTraverseClient final : public TraverseClient {
 public:
  explicit ConnectedTraverseClient(Connection& connection) : connection_(connection) {}

  absl::StatusOr<RemoteTraverse> Create(const std::string& id, const TraverseSettings& settings,
                                        const Stop& until) override {
    if (settings.reorder_window < 0) return absl::InvalidArgumentError("reorder_window must not be below 0");
    v1::CreateTraverseRequest request;
    request.set_traverse_id(id);
    *request.mutable_settings() = ToWire(settings);
    const auto response = Call(connection_, &v1::TraverseService::Stub::CreateTraverse, request, until);
    if (!response.ok()) return response.status();
    return FromWire(response->traverse());
  }

  absl::StatusOr<RemoteTraverse> Get(const std::string& name, const Stop& until) override {
    v1::GetTraverseRequest request;
    request.set_name(name);
    const auto response = Call(connection_, &v1::TraverseService::Stub::GetTraverse, request, until);
    if (!response.ok()) return response.status();
    return FromWire(response->traverse());
  }

  absl::StatusOr<std::vector<RemoteTraverse>> List(const Stop& until) override {
    std::vector<RemoteTraverse> result;
    v1::ListTraversesRequest request;
    request.set_page_size(kPageSize);
    do {
      const auto response = Call(connection_, &v1::TraverseService::Stub::ListTraverses, request, until);
      if (!response.ok()) return response.status();
      if (!response->next_page_token().empty() && response->traverses().empty()) {
        return absl::InternalError("the server answered an empty page of traverses that is not the last");
      }
      for (const v1::Traverse& message : response->traverses()) {
        absl::StatusOr<RemoteTraverse> traverse = FromWire(message);
        if (!traverse.ok()) return traverse.status();
        result.push_back(*std::move(traverse));
      }
      request.set_page_token(response->next_page_token());
    } while (!request.page_token().empty());
    return result;
  }

  absl::Status Delete(const std::string& name, const Stop& until) override {
    v1::DeleteTraverseRequest request;
    request.set_name(name);
    return CallDeletion(
        connection_,
        [&](const auto& channel, grpc::ClientContext* context) {
          v1::DeleteTraverseResponse response;
          return v1::TraverseService::NewStub(channel)->DeleteTraverse(context, request, &response);
        },
        until);
  }

  absl::StatusOr<RemoteTrajectory> GetTrajectory(const std::string& name, const Stop& until) override {
    for (int i = 0; i < kMaxReadings; ++i) {
      absl::StatusOr<std::optional<RemoteTrajectory>> trajectory = ReadTrajectory(name, until);
      if (!trajectory.ok()) return trajectory.status();
      if (trajectory->has_value()) return **std::move(trajectory);
    }
    return absl::UnavailableError("the trajectory changes faster than it can be read");
  }

  absl::StatusOr<OptimizationOutcome> Optimize(const std::string& name, bool find_loop_closures,
                                               std::stop_token cancellation) override {
    v1::OptimizeTraverseRequest request;
    request.set_name(name);
    request.set_find_loop_closures(find_loop_closures);
    const auto response = Call(connection_, &v1::TraverseService::Stub::OptimizeTraverse, request,
                               {std::move(cancellation), std::nullopt});
    if (!response.ok()) return response.status();
    return FromWire(*response);
  }

  absl::StatusOr<std::unique_ptr<ScanStreamer>> Stream(const std::string& name, const StreamOptions& options) override {
    return StreamScans(connection_, name, options);
  }

  absl::Status Watch(const std::string& name, const WatchOptions& options,
                     const std::function<void(const TraverseEvent&)>& on_event) override {
    return WatchTraverse(connection_, name, options, on_event);
  }

  absl::StatusOr<RemoteMap> DownloadMap(const std::string& name, const MapOptions& options) override {
    return internal::DownloadMap(connection_, name, options);
  }

 private:
  // Nullopt: poses were revised between two pages.
  absl::StatusOr<std::optional<RemoteTrajectory>> ReadTrajectory(const std::string& name, const Stop& until) {
    RemoteTrajectory result;
    v1::GetTrajectoryRequest request;
    request.set_name(name);
    request.set_page_size(kPageSize);
    bool is_first = true;
    do {
      const auto response = Call(connection_, &v1::TraverseService::Stub::GetTrajectory, request, until);
      const bool is_late = !is_first && absl::IsInvalidArgument(response.status());  // a token of an older version
      if (is_late) return std::nullopt;
      if (!response.ok()) return response.status();
      if (is_first) result.version = response->version();
      is_first = false;
      if (response->version() != result.version) return std::nullopt;
      if (!response->next_page_token().empty() && response->poses().empty()) {
        return absl::InternalError("the server answered an empty page of poses that is not the last");
      }
      for (const v1::TrajectoryPose& message : response->poses()) {
        const absl::StatusOr<curvereg::TrajectoryPose> pose = FromWire(message);
        if (!pose.ok()) return pose.status();
        result.poses.push_back(*pose);
      }
      request.set_page_token(response->next_page_token());
    } while (!request.page_token().empty());
    return result;
  }

  Connection& connection_;
};

}  // namespace

std::unique_ptr<TraverseClient> MakeTraverseClient(Connection& connection) {
  return std::make_unique<ConnectedTraverseClient>(connection);
}

}  // namespace curvereg::internal
