// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The calls with one request and one answer, and what all calls of the service have in common.
#include "server/scans/scan_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "absl/strings/str_cat.h"
#include "server/scans/scan_conversion.h"
#include "tests/server/scans/scan_server.h"
#include "tests/testing/matchers.h"
#include "tests/testing/scenes.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

using ::testing::ElementsAre;

const std::string kNobody = "scans/" + std::string(32, '0');

template <typename Request, typename Response>
using Method = grpc::Status (v1::ScanService::Stub::*)(grpc::ClientContext*, const Request&, Response*);

// Calls the method with a context of its own.
template <typename Request, typename Response>
absl::Status CallMethod(v1::ScanService::Stub& stub, Method<Request, Response> method, const Request& request,
                        Response* response) {
  grpc::ClientContext context;
  return wire::FromGrpcStatus((stub.*method)(&context, request, response));
}

absl::StatusOr<v1::Scan> GetScan(v1::ScanService::Stub& stub, const std::string& name) {
  v1::GetScanRequest request;
  request.set_name(name);
  v1::GetScanResponse response;
  const absl::Status status = CallMethod(stub, &v1::ScanService::Stub::GetScan, request, &response);
  if (!status.ok()) return status;
  return response.scan();
}

absl::StatusOr<v1::ListScansResponse> ListScans(v1::ScanService::Stub& stub, int page_size,
                                                const std::string& token = "") {
  v1::ListScansRequest request;
  request.set_page_size(page_size);
  request.set_page_token(token);
  v1::ListScansResponse response;
  const absl::Status status = CallMethod(stub, &v1::ScanService::Stub::ListScans, request, &response);
  if (!status.ok()) return status;
  return response;
}

absl::Status DeleteScan(v1::ScanService::Stub& stub, const std::string& name) {
  v1::DeleteScanRequest request;
  request.set_name(name);
  v1::DeleteScanResponse response;
  return CallMethod(stub, &v1::ScanService::Stub::DeleteScan, request, &response);
}

absl::StatusOr<v1::GetUploadResponse> GetUpload(v1::ScanService::Stub& stub, const std::string& upload) {
  v1::GetUploadRequest request;
  request.set_upload(upload);
  v1::GetUploadResponse response;
  const absl::Status status = CallMethod(stub, &v1::ScanService::Stub::GetUpload, request, &response);
  if (!status.ok()) return status;
  return response;
}

TEST(ScanService, TellsOfAScan) {
  ScanServer server;
  const auto stub = server.NewStub();
  const auto before = std::chrono::system_clock::now() - std::chrono::seconds(1);
  const auto done = Upload(*stub, "a", RandomCloud(100, 1));
  ASSERT_THAT(done, IsOk());
  const auto scan = GetScan(*stub, done->scan().name());
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(scan->SerializeAsString(), done->scan().SerializeAsString());
  EXPECT_GE(scan->create_time().seconds(), std::chrono::system_clock::to_time_t(before));
  EXPECT_LE(scan->create_time().seconds(), std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()));
}

TEST(ScanService, RefusesNamesOfScans) {
  ScanServer server;
  const auto stub = server.NewStub();
  EXPECT_EQ(ReasonText(GetScan(*stub, kNobody).status()), "SCAN_NOT_FOUND");
  EXPECT_EQ(ReasonText(DeleteScan(*stub, kNobody)), "SCAN_NOT_FOUND");
  for (const std::string& name : {std::string(), std::string("scans/x"), kNobody + "0", "scans/../" + kNobody}) {
    EXPECT_EQ(ReasonText(GetScan(*stub, name).status()), "INVALID_FIELD") << name;
    EXPECT_EQ(ReasonText(DeleteScan(*stub, name)), "INVALID_FIELD") << name;
  }
}

TEST(ScanService, ForgetsAScan) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  const auto done = Upload(*stub, "a", cloud);
  ASSERT_THAT(done, IsOk());
  ASSERT_THAT(DeleteScan(*stub, done->scan().name()), IsOk());
  EXPECT_EQ(ReasonText(GetScan(*stub, done->scan().name()).status()), "SCAN_NOT_FOUND");
  EXPECT_EQ(ReasonText(DeleteScan(*stub, done->scan().name())), "SCAN_NOT_FOUND");
  EXPECT_EQ(server.store().Statistics().stored_bytes, 0);
  const auto again = Upload(*stub, "b", cloud);
  ASSERT_THAT(again, IsOk());
  EXPECT_FALSE(again->already_stored());
  EXPECT_EQ(again->scan().name(), done->scan().name()) << "a scan is named by its content";
}

TEST(ScanService, ForgetsThePreparedScanWithIt) {
  ScanServer server;
  const auto stub = server.NewStub();
  const auto done = Upload(*stub, "a", RandomCloud(1000, 1));
  ASSERT_THAT(done, IsOk());
  int num_loads = 0;
  const auto load = [&](const Stop&) {
    ++num_loads;
    const auto patch = PatchPoints({.noise_m = 0.1}, 1000, 1);
    return PreparedScan::Create(std::make_shared<const Scan>(Scan{patch, {}}));
  };
  ASSERT_THAT(server.cache().Get(done->scan().name(), load, {}), IsOk());
  ASSERT_THAT(server.cache().Get(done->scan().name(), load, {}), IsOk());
  EXPECT_EQ(num_loads, 1);
  ASSERT_THAT(DeleteScan(*stub, done->scan().name()), IsOk());
  ASSERT_THAT(server.cache().Get(done->scan().name(), load, {}), IsOk());
  EXPECT_EQ(num_loads, 2);
}

TEST(ScanService, TellsOfAnUpload) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  SendAll(*stub, {StartMessage("a", cloud), ChunkMessage(cloud, 0, 700)}).IgnoreError();
  const auto upload = GetUpload(*stub, "uploads/a");
  ASSERT_THAT(upload, IsOk());
  EXPECT_EQ(upload->upload(), "uploads/a");
  EXPECT_EQ(upload->committed_offset(), 700);
  EXPECT_EQ(upload->payload_bytes(), 1200);
  EXPECT_GT(upload->expire_time().seconds(), std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()));
  EXPECT_EQ(ReasonText(GetUpload(*stub, "uploads/b").status()), "UPLOAD_NOT_FOUND");
  EXPECT_EQ(ReasonText(GetUpload(*stub, "a").status()), "INVALID_FIELD");
  ASSERT_THAT(Upload(*stub, "a", cloud), IsOk());
  EXPECT_EQ(ReasonText(GetUpload(*stub, "uploads/a").status()), "UPLOAD_NOT_FOUND");
}

TEST(ScanService, ListsScansInPagesNewestFirst) {
  ScanServer server;
  const auto stub = server.NewStub();
  EXPECT_EQ(ListScans(*stub, 10)->scans_size(), 0);
  std::vector<std::string> uploaded;
  for (uint64_t i = 0; i < 7; ++i) {
    const auto done = Upload(*stub, absl::StrCat("upload-", i), RandomCloud(100, i + 1));
    ASSERT_THAT(done, IsOk());
    uploaded.insert(uploaded.begin(), done->scan().name());
  }
  std::vector<std::string> listed;
  std::vector<int> sizes;
  std::string token;
  do {
    const auto page = ListScans(*stub, 3, token);
    ASSERT_THAT(page, IsOk());
    for (const v1::Scan& scan : page->scans()) listed.push_back(scan.name());
    sizes.push_back(page->scans_size());
    token = page->next_page_token();
  } while (!token.empty());
  EXPECT_EQ(listed, uploaded);
  EXPECT_THAT(sizes, ElementsAre(3, 3, 1));
}

TEST(ScanService, HoldsPagesToTheirLimits) {
  ScanServer server;
  const auto stub = server.NewStub();
  for (int i = 0; i < 101; ++i) {
    ASSERT_THAT(Upload(*stub, absl::StrCat("upload-", i), RandomCloud(4, static_cast<uint64_t>(i + 1))), IsOk());
  }
  EXPECT_EQ(ListScans(*stub, 0)->scans_size(), 100);
  EXPECT_EQ(ListScans(*stub, 1'000'000'000)->scans_size(), 101);
  EXPECT_EQ(ReasonText(ListScans(*stub, -1).status()), "INVALID_FIELD");
  EXPECT_EQ(ReasonText(ListScans(*stub, 10, "not ours").status()), "INVALID_FIELD");
}

// Refuses everybody.
class Closed : public server::Access {
 public:
  absl::StatusOr<std::string> Check(std::string_view, server::Scope needed) const override {
    asked.insert(needed);
    return wire::MakeError(v1::ERROR_REASON_UNAUTHENTICATED, "nobody may");
  }
  mutable std::set<server::Scope> asked;
};

// Each method, tried on a scan and an upload that are not there.
std::vector<absl::Status> TryAll(v1::ScanService::Stub& stub) {
  v1::DownloadScanRequest download;
  download.set_name(kNobody);
  return {
      GetScan(stub, kNobody).status(), ListScans(stub, 1).status(), GetUpload(stub, "uploads/a").status(),
      Download(stub, download).status, DeleteScan(stub, kNobody),   Upload(stub, "a", RandomCloud(100, 1)).status()};
}

TEST(ScanService, LetsNobodyInWithoutLeave) {
  const Closed closed;
  ScanServerOptions options;
  options.access = &closed;
  ScanServer server(options);
  const auto stub = server.NewStub();
  for (const absl::Status& status : TryAll(*stub)) EXPECT_EQ(ReasonText(status), "UNAUTHENTICATED");
  EXPECT_THAT(closed.asked, ElementsAre(server::Scope::kRead, server::Scope::kWrite));
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

TEST(ScanService, RefusesNewCallsWhileDraining) {
  ScanServer server;
  const auto stub = server.NewStub();
  server.Drain();
  for (const absl::Status& status : TryAll(*stub)) EXPECT_EQ(ReasonText(status), "NOT_SERVING");
}

TEST(ScanService, CountsCallsByTheirEnd) {
  ScanServer server;
  const auto stub = server.NewStub();
  GetScan(*stub, kNobody).status().IgnoreError();
  ASSERT_THAT(ListScans(*stub, 1), IsOk());
  EXPECT_EQ(MetricValue(server, "grpc_server_handled_total", "GetScan"), 1);
  EXPECT_EQ(MetricValue(server, "grpc_server_msg_received_total", "GetScan"), 1);
  EXPECT_EQ(MetricValue(server, "grpc_server_msg_sent_total", "GetScan"), 0);
  EXPECT_EQ(MetricValue(server, "grpc_server_msg_sent_total", "ListScans"), 1);
}

}  // namespace
}  // namespace curvereg::testing
