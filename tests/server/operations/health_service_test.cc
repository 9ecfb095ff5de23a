// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/health_service.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace curvereg::server {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

// A health service on a port of its own.
class HealthServiceTest : public ::testing::Test {
 protected:
  HealthServiceTest() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&health_);
    server_ = builder.BuildAndStart();
    stub_ =
        Health::NewStub(grpc::CreateChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials()));
  }

  // The status, or nullopt for NOT_FOUND.
  std::optional<HealthCheckResponse::ServingStatus> Check(const std::string& service) {
    grpc::ClientContext context;
    HealthCheckRequest request;
    request.set_service(service);
    HealthCheckResponse response;
    const grpc::Status status = stub_->Check(&context, request, &response);
    if (status.error_code() == grpc::StatusCode::NOT_FOUND) return std::nullopt;
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.status();
  }

  HealthService health_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Health::Stub> stub_;
};

// One open Watch.
struct WatchStream {
  WatchStream(Health::Stub& stub, const std::string& service) {
    HealthCheckRequest request;
    request.set_service(service);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    reader = stub.Watch(&context, request);
  }
  std::optional<HealthCheckResponse::ServingStatus> Next() {
    HealthCheckResponse response;
    return reader->Read(&response) ? std::optional(response.status()) : std::nullopt;
  }
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<HealthCheckResponse>> reader;
};

TEST_F(HealthServiceTest, ChecksServicesByName) {
  EXPECT_EQ(Check(""), std::nullopt);
  health_.SetServing("", true);
  health_.SetServing("a.Service", false);
  EXPECT_EQ(Check(""), HealthCheckResponse::SERVING);
  EXPECT_EQ(Check("a.Service"), HealthCheckResponse::NOT_SERVING);
  EXPECT_EQ(Check("b.Service"), std::nullopt);
}

TEST_F(HealthServiceTest, DrainsForGood) {
  health_.SetServing("", true);
  health_.Drain();
  EXPECT_EQ(Check(""), HealthCheckResponse::NOT_SERVING);
  health_.SetServing("", true);
  EXPECT_EQ(Check(""), HealthCheckResponse::NOT_SERVING);
}

TEST_F(HealthServiceTest, WatchersSeeChangesAndNothingElse) {
  WatchStream watch(*stub_, "a.Service");
  EXPECT_EQ(watch.Next(), HealthCheckResponse::SERVICE_UNKNOWN);
  health_.SetServing("a.Service", true);
  EXPECT_EQ(watch.Next(), HealthCheckResponse::SERVING);
  health_.SetServing("a.Service", true);  // no change
  health_.SetServing("b.Service", false);
  health_.Drain();
  EXPECT_EQ(watch.Next(), HealthCheckResponse::NOT_SERVING);
  watch.context.TryCancel();
  EXPECT_EQ(watch.Next(), std::nullopt);
  EXPECT_EQ(watch.reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(HealthServiceTest, EndedWatchesDoNotHoldTheServerUp) {
  health_.SetServing("", true);
  WatchStream watch(*stub_, "");
  EXPECT_EQ(watch.Next(), HealthCheckResponse::SERVING);
  health_.EndWatches();
  EXPECT_EQ(watch.Next(), std::nullopt);
  EXPECT_EQ(watch.reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  WatchStream late(*stub_, "");
  EXPECT_EQ(late.Next(), std::nullopt);
  EXPECT_EQ(late.reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  const auto begin = std::chrono::steady_clock::now();
  server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(15));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(HealthServiceTest, EveryWatcherEndsWithTheLastStatus) {
  std::vector<std::unique_ptr<WatchStream>> watches;
  for (int i = 0; i < 20; ++i) {
    watches.push_back(std::make_unique<WatchStream>(*stub_, "s"));
    EXPECT_EQ(watches.back()->Next(), HealthCheckResponse::SERVICE_UNKNOWN);
  }
  {
    std::vector<std::jthread> setters;
    for (int t = 0; t < 3; ++t) {
      setters.emplace_back([this, t] {
        for (int i = 0; i < 100; ++i) health_.SetServing("s", (i + t) % 2 == 0);
      });
    }
    for (int i = 0; i < 5; ++i) {  // some leave meanwhile
      watches.back()->context.TryCancel();
      watches.back()->reader->Finish();
      watches.pop_back();
    }
  }
  health_.SetServing("s", false);
  health_.SetServing("s", true);
  health_.EndWatches();
  for (const auto& watch : watches) {
    std::optional<HealthCheckResponse::ServingStatus> last;
    while (const auto next = watch->Next()) {
      EXPECT_NE(next, last);
      last = next;
    }
    EXPECT_TRUE(last.has_value());
    EXPECT_EQ(watch->reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  }
}

}  // namespace
}  // namespace curvereg::server
