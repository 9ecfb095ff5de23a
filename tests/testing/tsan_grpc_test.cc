// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// That ThreadSanitizer, as the tsan build uses it, sees a race in a handler and is silent where a lock prevents it.
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "grpc/health/v1/health.grpc.pb.h"

namespace curvereg::testing {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

constexpr int kNumMessages = 20;

// Writes messages, as our streams do: a thread of ours counts what it does, and so does the reaction of gRPC's.
class CountingStream final : public grpc::ServerWriteReactor<HealthCheckResponse> {
 public:
  explicit CountingStream(bool locked) : locked_(locked) {
    StartWrite(&response_);
    worker_ = std::thread([this] {
      for (int i = 0; i < kNumMessages; ++i) Count();
    });
  }

  void OnWriteDone(bool ok) override {
    Count();
    if (ok && ++num_written_ < kNumMessages) {
      StartWrite(&response_);
    } else {
      Finish(grpc::Status::OK);
    }
  }
  void OnDone() override {
    worker_.join();
    delete this;
  }

 private:
  void Count() {
    if (locked_) {
      const std::lock_guard lock(mutex_);
      ++count_;
    } else {
      ++count_;
    }
  }

  const bool locked_;
  HealthCheckResponse response_;
  int num_written_ = 0;  // of the reactions, which follow one another
  std::mutex mutex_;
  int count_ = 0;
  std::thread worker_;
};

class CountingService final : public Health::CallbackService {
 public:
  explicit CountingService(bool locked) : locked_(locked) {}
  grpc::ServerWriteReactor<HealthCheckResponse>* Watch(grpc::CallbackServerContext* /*context*/,
                                                       const HealthCheckRequest* /*request*/) override {
    return new CountingStream(locked_);
  }

 private:
  const bool locked_;
};

// Ends the process: with 0, or as ThreadSanitizer has it.
[[noreturn]] void ServeAndExit(bool locked) {
  {
    CountingService service(locked);
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service);
    const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
    const std::unique_ptr<Health::Stub> stub =
        Health::NewStub(grpc::CreateChannel(absl::StrCat("127.0.0.1:", port), grpc::InsecureChannelCredentials()));
    for (int call = 0; call < 5; ++call) {
      grpc::ClientContext context;
      const auto stream = stub->Watch(&context, HealthCheckRequest());
      HealthCheckResponse response;
      while (stream->Read(&response)) {
      }
      if (!stream->Finish().ok()) std::exit(3);
    }
    server->Shutdown();
  }
  std::exit(0);
}

class TsanGrpcTest : public ::testing::Test {
 protected:
  // The child is another process, which reads this anew; its reports are not those of the test.
  void SetUp() override {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const char* const options = std::getenv("TSAN_OPTIONS");
    setenv("TSAN_OPTIONS", absl::StrCat(options == nullptr ? "" : options, " log_path=stderr exitcode=66").c_str(), 1);
  }
};

TEST_F(TsanGrpcTest, SeesARaceOfAReactionAndAThread) {
  EXPECT_EXIT(ServeAndExit(/*locked=*/false), ::testing::ExitedWithCode(66), "data race.*CountingStream");
}

TEST_F(TsanGrpcTest, IsSilentWhereALockPreventsIt) {
  EXPECT_EXIT(ServeAndExit(/*locked=*/true), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace curvereg::testing
