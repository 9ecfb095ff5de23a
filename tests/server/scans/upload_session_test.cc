// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What an upload refuses, and what is left of it then. All over a real connection.
#include "server/scans/upload_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "absl/strings/str_cat.h"
#include "tests/server/scans/scan_server.h"
#include "tests/testing/matchers.h"

namespace curvereg::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  const std::optional<google::rpc::BadRequest> bad_request = wire::BadRequestOf(status);
  if (!bad_request.has_value()) return fields;
  for (const auto& violation : bad_request->field_violations()) fields.push_back(violation.field());
  return fields;
}

// Where the upload should be gone.
std::string UploadReason(ScanServer& server, const std::string& upload) {
  return ReasonText(server.store().GetUpload(upload).status());
}

struct StartCase {
  std::string field;
  std::function<void(v1::UploadScanStart&)> spoil;
};

TEST(UploadSession, RefusesAStartByTheNameOfItsField) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  const std::vector<StartCase> cases = {
      {"start.upload", [](v1::UploadScanStart& s) { s.clear_upload(); }},
      {"start.upload", [](v1::UploadScanStart& s) { s.set_upload("uploads/"); }},
      {"start.upload", [](v1::UploadScanStart& s) { s.set_upload("scans/a"); }},
      {"start.upload", [](v1::UploadScanStart& s) { s.set_upload("uploads/A"); }},
      {"start.upload", [](v1::UploadScanStart& s) { s.set_upload("uploads/../a"); }},
      {"start.upload", [](v1::UploadScanStart& s) { s.set_upload("uploads/" + std::string(65, 'a')); }},
      {"start.header", [](v1::UploadScanStart& s) { s.clear_header(); }},
      {"start.header.encoding", [](v1::UploadScanStart& s) { s.mutable_header()->clear_encoding(); }},
      {"start.payload_bytes", [](v1::UploadScanStart& s) { s.clear_payload_bytes(); }},
      {"start.payload_digest.value",
       [](v1::UploadScanStart& s) { s.mutable_payload_digest()->mutable_value()->pop_back(); }},
      {"start.payload_digest.algorithm",
       [](v1::UploadScanStart& s) { s.mutable_payload_digest()->set_algorithm(v1::DIGEST_ALGORITHM_UNSPECIFIED); }},
  };
  for (const StartCase& bad : cases) {
    v1::UploadScanRequest request = StartMessage("a", cloud);
    bad.spoil(*request.mutable_start());
    SCOPED_TRACE(request.ShortDebugString());
    const absl::Status status = SendAll(*stub, {request});
    EXPECT_EQ(ReasonText(status), "INVALID_FIELD");
    EXPECT_THAT(FieldsOf(status), ElementsAre(bad.field)) << status;
  }
  EXPECT_EQ(server.store().Statistics().num_uploads, 0);
}

TEST(UploadSession, TakesTheLongestName) {
  ScanServer server;
  EXPECT_THAT(Upload(*server.NewStub(), std::string(62, 'z') + "-0", RandomCloud(100, 1)), IsOk());
}

TEST(UploadSession, RefusesMessagesInAnotherOrder) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  const v1::UploadScanRequest start = StartMessage("a", cloud);
  const v1::UploadScanRequest chunk = ChunkMessage(cloud, 0, 10);
  const std::vector<std::vector<v1::UploadScanRequest>> orders = {{},
                                                                  {chunk},
                                                                  {FinishMessage()},
                                                                  {v1::UploadScanRequest()},
                                                                  {start},
                                                                  {start, start},
                                                                  {start, chunk},
                                                                  {start, chunk, start},
                                                                  {start, v1::UploadScanRequest()}};
  for (size_t i = 0; i < orders.size(); ++i) {
    SCOPED_TRACE(absl::StrCat("order ", i));
    v1::PointCloud fresh = cloud;
    std::vector<v1::UploadScanRequest> messages = orders[i];
    for (v1::UploadScanRequest& message : messages) {
      if (message.has_start()) message.mutable_start()->set_upload(absl::StrCat("uploads/order-", i));
    }
    const absl::Status status = SendAll(*stub, messages);
    EXPECT_EQ(ReasonText(status), "UNEXPECTED_MESSAGE");
    EXPECT_THAT(status, HasCode(absl::StatusCode::kInvalidArgument));
  }
  EXPECT_EQ(CommittedBytes(server, "order-6"), 10) << "what came in order stays";
}

struct ChunkCase {
  std::string reason;
  uint64_t offset;
  uint64_t size;
  std::function<void(v1::PayloadChunk&)> spoil = [](v1::PayloadChunk&) {};
};

TEST(UploadSession, RefusesAChunkAndKeepsWhatWasThere) {
  ScanServerOptions options;
  options.limits.max_chunk_bytes = 500;
  ScanServer server(options);
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  ASSERT_EQ(cloud.data().size(), 1200);
  const std::vector<ChunkCase> cases = {
      {"OFFSET_OUT_OF_RANGE", 401, 10},  // a gap
      {"OFFSET_OUT_OF_RANGE", 0, 400},   // again
      {"OFFSET_OUT_OF_RANGE", 399, 10},
      {"OFFSET_OUT_OF_RANGE", 400, 10, [](v1::PayloadChunk& c) { c.set_offset(~uint64_t{0}); }},
      {"CHECKSUM_MISMATCH", 400, 10, [](v1::PayloadChunk& c) { (*c.mutable_data())[3] ^= 1; }},
      {"CHECKSUM_MISMATCH", 400, 10, [](v1::PayloadChunk& c) { c.set_crc32c(0); }},
      {"INVALID_FIELD", 400, 10, [](v1::PayloadChunk& c) { c.clear_crc32c(); }},
      {"INVALID_FIELD", 400, 0},
      {"INVALID_FIELD", 400, 501},
  };
  int i = 0;
  for (const ChunkCase& bad : cases) {
    const std::string upload = absl::StrCat("chunk-", i++);
    SCOPED_TRACE(upload);
    v1::UploadScanRequest spoilt = ChunkMessage(cloud, bad.offset, bad.size);
    bad.spoil(*spoilt.mutable_chunk());
    const absl::Status status =
        SendAll(*stub, {StartMessage(upload, cloud), ChunkMessage(cloud, 0, 400), spoilt, FinishMessage()});
    EXPECT_EQ(ReasonText(status), bad.reason) << status;
    EXPECT_EQ(MetadataOf(status, "committed_offset"), bad.reason == "OFFSET_OUT_OF_RANGE" ? "400" : "");
    EXPECT_EQ(CommittedBytes(server, upload), 400);
    EXPECT_THAT(Upload(*stub, upload, cloud, 500), IsOk()) << "the upload is not lost";
    const absl::StatusOr<server::ScanPage> page = server.store().ListScans(10, "");
    ASSERT_THAT(page, IsOk());
    ASSERT_THAT(page->scans, SizeIs(1));
    ASSERT_THAT(server.store().DeleteScan(page->scans[0].id), IsOk());
  }
}

TEST(UploadSession, RefusesBytesBeyondTheDeclaredSize) {
  ScanServer server;
  v1::PointCloud cloud = RandomCloud(100, 1);
  const v1::UploadScanRequest start = StartMessage("a", cloud);
  cloud.mutable_data()->append("more");
  const absl::Status status =
      SendAll(*server.NewStub(), {start, ChunkMessage(cloud, 0, 1000), ChunkMessage(cloud, 1000, 204)});
  EXPECT_EQ(ReasonText(status), "OFFSET_OUT_OF_RANGE");
  EXPECT_EQ(MetadataOf(status, "committed_offset"), "1000");
}

TEST(UploadSession, WantsAllBytesBeforeFinish) {
  ScanServer server;
  const v1::PointCloud cloud = RandomCloud(100, 1);
  const absl::Status status =
      SendAll(*server.NewStub(), {StartMessage("a", cloud), ChunkMessage(cloud, 0, 1199), FinishMessage()});
  EXPECT_EQ(ReasonText(status), "OFFSET_OUT_OF_RANGE");
  EXPECT_EQ(MetadataOf(status, "committed_offset"), "1199");
}

TEST(UploadSession, WantsOneDigestOrTwoAlike) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  const v1::UploadScanRequest chunk = ChunkMessage(cloud, 0, 1200);
  const absl::Status without = SendAll(*stub, {StartMessage("a", cloud, false), chunk, FinishMessage()});
  EXPECT_THAT(FieldsOf(without), ElementsAre("finish.payload_digest")) << without;
  const absl::Status other = SendAll(*stub, {StartMessage("b", cloud), chunk, FinishMessage(Xxh3("other"))});
  EXPECT_THAT(FieldsOf(other), ElementsAre("finish.payload_digest")) << other;
  v1::Digest cut = Xxh3(cloud.data());
  cut.mutable_value()->pop_back();
  const absl::Status bad = SendAll(*stub, {StartMessage("c", cloud, false), chunk, FinishMessage(cut)});
  EXPECT_THAT(FieldsOf(bad), ElementsAre("finish.payload_digest.value")) << bad;
  EXPECT_EQ(CommittedBytes(server, "a"), 1200) << "the bytes are not at fault";
  EXPECT_THAT(SendAll(*stub, {StartMessage("a", cloud, false), FinishMessage(Xxh3(cloud.data()))}), IsOk());
}

TEST(UploadSession, TakesSha256) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  v1::UploadScanRequest start = StartMessage("a", cloud);
  *start.mutable_start()->mutable_payload_digest() = Sha256(cloud.data());
  EXPECT_THAT(SendAll(*stub, {start, ChunkMessage(cloud, 0, 1200), FinishMessage()}), IsOk());
  EXPECT_EQ(server.store().Statistics().num_scans, 1);
  EXPECT_EQ(server.memory().reserved_bytes(), 0);
}

TEST(UploadSession, ForgetsAPayloadOfAnotherDigest) {
  ScanServer server;
  const auto stub = server.NewStub();
  const v1::PointCloud cloud = RandomCloud(100, 1);
  for (const v1::Digest& digest : {Xxh3("other"), Sha256("other")}) {
    const absl::Status status =
        SendAll(*stub, {StartMessage("a", cloud, false), ChunkMessage(cloud, 0, 1200), FinishMessage(digest)});
    EXPECT_EQ(ReasonText(status), "DIGEST_MISMATCH");
    EXPECT_EQ(UploadReason(server, "a"), "UPLOAD_NOT_FOUND");
  }
  EXPECT_EQ(server.store().Statistics().stored_bytes, 0);
  EXPECT_EQ(server.memory().reserved_bytes(), 0);
  EXPECT_EQ(MetricValue(server, "curvereg_checksum_failures_total"), 2);
}

TEST(UploadSession, ForgetsAPayloadThatDoesNotDecode) {
  ScanServer server;
  const auto stub = server.NewStub();
  v1::PointCloud cloud = RandomCloud(100, 1);
  cloud.mutable_header()->set_encoding(v1::POINT_ENCODING_SHUFFLED_ZSTD);
  EXPECT_EQ(ReasonText(Upload(*stub, "a", cloud).status()), "MALFORMED_PAYLOAD");
  EXPECT_EQ(UploadReason(server, "a"), "UPLOAD_NOT_FOUND");
  EXPECT_EQ(server.store().Statistics().num_scans, 0);
  EXPECT_EQ(server.memory().reserved_bytes(), 0);
}

}  // namespace
}  // namespace curvereg::testing
