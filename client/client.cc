// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/client.h"

#include <optional>
#include <utility>

#include "client/connection.h"
#include "client/download.h"
#include "client/registration.h"
#include "client/remote_scan.h"
#include "client/retry.h"
#include "client/server_status.h"
#include "client/traverse_client.h"
#include "client/upload.h"
#include "curvereg/v1/registration_service.grpc.pb.h"
#include "curvereg/v1/scan_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg {
namespace {

using internal::CallDeletion;
using internal::CallUnary;
using internal::Connection;
using internal::ScanInputOf;

constexpr int kPageSize = 1000;

RemotePictures PicturesFrom(v1::RenderScanResponse& response) {
  RemotePictures result;
  for (v1::RenderedPicture& picture : *response.mutable_pictures()) {
    result.pictures.push_back({picture.name(), std::move(*picture.mutable_png())});
  }
  result.num_points = response.point_count();
  for (const v1::KeypointCount& count : response.keypoint_counts()) {
    result.num_keypoints.emplace_back(count.view(), static_cast<int>(count.count()));
  }
  return result;
}

class ConnectedClient final : public Client {
 public:
  explicit ConnectedClient(std::unique_ptr<Connection> connection)
      : connection_(std::move(connection)), traverses_(internal::MakeTraverseClient(*connection_)) {}

  absl::StatusOr<RegistrationResult> RegisterScans(const ScanReference& source, const ScanReference& target,
                                                   const RegistrationOptions& options,
                                                   const TransferEncoding& encoding) override {
    return internal::RegisterScans(*connection_, source, target, options, encoding);
  }

  absl::StatusOr<RemotePictures> RenderScan(const ScanReference& scan, int num_threads,
                                            std::stop_token cancellation) override {
    if (num_threads < 0) return absl::InvalidArgumentError("num_threads must not be below 0");
    absl::StatusOr<v1::ScanInput> input = ScanInputOf(scan, {TransferEncoding::Kind::kLossless});
    if (!input.ok()) return input.status();
    v1::RenderScanRequest request;
    *request.mutable_scan() = *std::move(input);
    request.set_max_threads(static_cast<uint32_t>(num_threads));
    v1::RenderScanResponse response;
    const absl::Status status =
        CallUnary(*connection_,
                  [&](const auto& channel, grpc::ClientContext* context) {
                    return v1::RegistrationService::NewStub(channel)->RenderScan(context, request, &response);
                  },
                  {cancellation, std::nullopt});
    if (!status.ok()) return status;
    return PicturesFrom(response);
  }

  absl::StatusOr<UploadOutcome> UploadScan(const Scan& scan, const TransferOptions& options) override {
    return internal::UploadScan(*connection_, scan, options);
  }

  absl::StatusOr<Scan> DownloadScan(const std::string& name, const TransferOptions& options) override {
    return internal::DownloadScan(*connection_, name, options);
  }

  absl::StatusOr<RemoteScan> GetScan(const std::string& name, const Stop& until) override {
    v1::GetScanRequest request;
    request.set_name(name);
    v1::GetScanResponse response;
    const absl::Status status = CallUnary(
        *connection_,
        [&](const auto& channel, grpc::ClientContext* context) {
          return v1::ScanService::NewStub(channel)->GetScan(context, request, &response);
        },
        until);
    if (!status.ok()) return status;
    return internal::FromWire(response.scan());
  }

  absl::StatusOr<std::vector<RemoteScan>> ListScans(const Stop& until) override {
    std::vector<RemoteScan> result;
    v1::ListScansRequest request;
    request.set_page_size(kPageSize);
    do {
      v1::ListScansResponse response;
      const absl::Status status = CallUnary(
          *connection_,
          [&](const auto& channel, grpc::ClientContext* context) {
            return v1::ScanService::NewStub(channel)->ListScans(context, request, &response);
          },
          until);
      if (!status.ok()) return status;
      if (!response.next_page_token().empty() && response.scans().empty()) {
        return absl::InternalError("the server answered an empty page of scans that is not the last");
      }
      for (const v1::Scan& scan : response.scans()) result.push_back(internal::FromWire(scan));
      request.set_page_token(response.next_page_token());
    } while (!request.page_token().empty());
    return result;
  }

  absl::Status DeleteScan(const std::string& name, const Stop& until) override {
    v1::DeleteScanRequest request;
    request.set_name(name);
    return CallDeletion(
        *connection_,
        [&](const auto& channel, grpc::ClientContext* context) {
          v1::DeleteScanResponse response;
          return v1::ScanService::NewStub(channel)->DeleteScan(context, request, &response);
        },
        until);
  }

  absl::StatusOr<ServerStatus> Status(const Stop& until) override {
    return internal::FetchServerStatus(*connection_, until);
  }

  TraverseClient& traverses() override { return *traverses_; }

 private:
  const std::unique_ptr<Connection> connection_;
  const std::unique_ptr<TraverseClient> traverses_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Client>> Client::Connect(const std::string& target, const ClientOptions& options,
                                                        std::stop_token cancellation) {
  absl::StatusOr<std::unique_ptr<Connection>> connection = Connection::Open(target, options);
  if (!connection.ok()) return connection.status();
  const absl::Status ready =
      (*connection)->AwaitReady({std::move(cancellation), std::chrono::steady_clock::now() + options.connect_timeout});
  if (absl::IsCancelled(ready)) return ready;
  if (!ready.ok()) return internal::ExplainNoConnection(**connection, ready);
  return std::make_unique<ConnectedClient>(*std::move(connection));
}

std::unique_ptr<Client> Client::OverChannel(std::shared_ptr<grpc::Channel> channel, const ClientOptions& options) {
  return std::make_unique<ConnectedClient>(Connection::Over(std::move(channel), options));
}

std::string ErrorReasonName(const absl::Status& status) {
  const std::optional<google::rpc::ErrorInfo> info = wire::ErrorInfoOf(status);
  return info.has_value() && info->domain() == wire::kErrorDomain ? info->reason() : std::string();
}

}  // namespace curvereg
