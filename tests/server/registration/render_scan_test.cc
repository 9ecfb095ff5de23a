// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "render/scan_pictures.h"
#include "tests/server/registration/registration_server.h"
#include "tests/server/store/throwing_store.h"
#include "tests/testing/matchers.h"

namespace curvereg::server {
namespace {

using testing::CloudOf;
using testing::IsOk;
using testing::RegistrationServer;
using testing::SourceScan;

constexpr char kPngSignature[] = "\x89PNG\r\n\x1a\n";

v1::RenderScanRequest RequestFor(const Scan& scan) {
  v1::RenderScanRequest request;
  *request.mutable_scan()->mutable_inline_scan() = CloudOf(scan);
  return request;
}

TEST(RenderScanTest, DrawsAllThatTheLibraryDraws) {
  RegistrationServer server;
  const auto response = server.Render(RequestFor(SourceScan()));
  ASSERT_THAT(response, IsOk());
  const auto drawn = DrawScan(SourceScan());
  ASSERT_THAT(drawn, IsOk());
  ASSERT_EQ(response->pictures_size(), static_cast<int>(drawn->pictures.size()));
  std::set<std::string> names;
  for (int i = 0; i < response->pictures_size(); ++i) {
    const v1::RenderedPicture& picture = response->pictures(i);
    EXPECT_TRUE(picture.png().starts_with(kPngSignature)) << picture.name();
    EXPECT_NE(picture.kind(), v1::PICTURE_KIND_UNSPECIFIED);
    EXPECT_EQ(picture.name(), drawn->pictures[static_cast<size_t>(i)].name);
    EXPECT_EQ(picture.png(), *EncodePng(drawn->pictures[static_cast<size_t>(i)].picture)) << picture.name();
    names.insert(picture.name());
  }
  EXPECT_EQ(names.size(), drawn->pictures.size());
  EXPECT_EQ(response->point_count(), SourceScan().points.size());
  ASSERT_EQ(response->keypoint_counts_size(), 3);
  EXPECT_EQ(response->keypoint_counts(1).view(), "elevation");
  EXPECT_GT(response->keypoint_counts(1).count(), 10U);
  EXPECT_TRUE(testing::BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
}

TEST(RenderScanTest, DrawsTheKindsAskedFor) {
  RegistrationServer server;
  v1::RenderScanRequest request;
  request.mutable_scan()->set_name(server.Store(CloudOf(SourceScan())));
  request.add_kinds(v1::PICTURE_KIND_VIEWS);
  request.add_kinds(v1::PICTURE_KIND_VIEWS);
  request.set_max_threads(1);
  const auto response = server.Render(request);
  ASSERT_THAT(response, IsOk());
  ASSERT_EQ(response->pictures_size(), 4);
  for (const v1::RenderedPicture& picture : response->pictures()) EXPECT_EQ(picture.kind(), v1::PICTURE_KIND_VIEWS);
}

TEST(RenderScanTest, WrongFieldsAndScansAreNamed) {
  RegistrationServer server;
  const auto field_of = [&](const v1::RenderScanRequest& request) {
    const auto bad_request = wire::BadRequestOf(server.Render(request).status());
    return bad_request.has_value() ? bad_request->field_violations(0).field() : std::string();
  };
  v1::RenderScanRequest request = RequestFor(SourceScan());
  request.add_kinds(v1::PICTURE_KIND_UNSPECIFIED);
  EXPECT_EQ(field_of(request), "kinds");
  request.set_kinds(0, static_cast<v1::PictureKind>(77));
  EXPECT_EQ(field_of(request), "kinds");
  EXPECT_EQ(field_of({}), "scan");
  Scan nowhere;
  nowhere.points.assign(500, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(field_of(RequestFor(nowhere)), "scan");
  EXPECT_EQ(wire::ReasonOf(server.Render(RequestFor(nowhere)).status()), v1::ERROR_REASON_UNUSABLE_SCAN);
}

TEST(ComputingCallTest, ExceptionsOfLibrariesAreInternalErrors) {
  RegistrationServer real;
  const std::string name = real.Store(CloudOf(SourceScan()));
  ThrowingStore store(real.store());
  RegistrationServer server({.store = &store});
  v1::RenderScanRequest render;
  render.mutable_scan()->set_name(name);
  v1::RegisterScansRequest registration;
  *registration.mutable_source() = *registration.mutable_target() = render.scan();
  for (const bool throws_early : {false, true}) {
    store.throws_early = throws_early;
    for (const absl::Status& status : {server.Render(render).status(), server.Register(registration).status()}) {
      EXPECT_EQ(wire::ReasonOf(status), v1::ERROR_REASON_INTERNAL) << status;
      EXPECT_EQ(std::string(status.message()).find("bad_alloc"), std::string::npos);  // nothing of the inside
    }
  }
  EXPECT_TRUE(testing::BecomesTrue([&] { return server.memory.reserved_bytes() == 0; }));
  EXPECT_THAT(server.Render(RequestFor(SourceScan())), IsOk());  // it serves on
}

}  // namespace
}  // namespace curvereg::server
