// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as the request of a call with one request, sent to the services of scans and traverses as gRPC runs them.
// The first byte picks the method, the rest is what comes on the wire.
#include <array>
#include <chrono>
#include <string>
#include <string_view>

#include "curvereg/v1/scan_service.pb.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "fuzz/called_services.h"
#include "fuzz/request_checks.h"
#include "server/store/page_token.h"
#include "tests/testing/generic_call.h"

namespace curvereg::server {
namespace {

constexpr std::array kMethods = {
    "/curvereg.v1.ScanService/GetScan",
    "/curvereg.v1.ScanService/DeleteScan",
    "/curvereg.v1.ScanService/ListScans",
    "/curvereg.v1.ScanService/GetUpload",
    "/curvereg.v1.ScanService/DownloadScan",
    "/curvereg.v1.TraverseService/CreateTraverse",
    "/curvereg.v1.TraverseService/GetTraverse",
    "/curvereg.v1.TraverseService/ListTraverses",
    "/curvereg.v1.TraverseService/GetTrajectory",
    "/curvereg.v1.TraverseService/WatchTraverse",
    "/curvereg.v1.TraverseService/DownloadMap",
    "/curvereg.v1.TraverseService/OptimizeTraverse",
    "/curvereg.v1.TraverseService/DeleteTraverse",
};

constexpr std::chrono::seconds kPatience(8);

void CheckPageToken(std::string_view bytes) {
  Decode<v1::ListScansRequest>(bytes, [](const auto& request) {
    const std::optional<int64_t> place = PlaceOfToken(request.page_token());
    if (place.has_value()) Require(TokenOfPlace(*place) == request.page_token());
  });
}

void CheckCall(uint8_t kind, std::string_view bytes) {
  static CalledServices& services = *new CalledServices();
  const std::string method = kMethods[kind % kMethods.size()];
  std::string request(bytes);
  if (method.ends_with("ListScans")) CheckPageToken(bytes);
  if (method.ends_with("WatchTraverse")) {
    v1::WatchTraverseRequest existing_only;  // or it would never end
    existing_only.set_existing_only(true);
    request += existing_only.SerializeAsString();
  }
  const absl::Status end = wire::FromGrpcStatus(testing::Send(services.stub(), method, request, kPatience));
  CheckError(end);
  Require(wire::ReasonOf(end) != v1::ERROR_REASON_STORAGE_FAULT);
  if (end.ok()) services.Restore();
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckCall(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
