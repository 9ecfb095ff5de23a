// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/watch_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/server/traverses/fake_traverses.h"
#include "tests/server/traverses/stream_server.h"
#include "tests/testing/matchers.h"
#include "wire/status_mapping.h"

namespace curvereg::testing {
namespace {

constexpr int kNumEvents = 20;  // more than are read at once

class Watcher {
 public:
  Watcher(v1::TraverseService::Stub& stub, uint64_t first_event, bool existing_only,
          const std::string& name = FakeTraverses::kName) {
    v1::WatchTraverseRequest request;
    request.set_name(name);
    request.set_first_event(first_event);
    request.set_existing_only(existing_only);
    stream_ = stub.WatchTraverse(&context_, request);
  }
  ~Watcher() {
    context_.TryCancel();
    if (!ended_) End().IgnoreError();
  }

  std::optional<v1::WatchTraverseResponse> Receive() {
    v1::WatchTraverseResponse response;
    if (!stream_->Read(&response)) return std::nullopt;
    return response;
  }
  // Receives `number` events, which must be those from `first` on.
  void Expect(uint64_t first, int number) {
    for (int i = 0; i < number; ++i) {
      const std::optional<v1::WatchTraverseResponse> event = Receive();
      ASSERT_TRUE(event.has_value()) << "after " << i;
      ASSERT_EQ(event->event(), first + static_cast<uint64_t>(i));
    }
  }
  absl::Status End() {
    while (Receive().has_value()) {
    }
    ended_ = true;
    return wire::FromGrpcStatus(stream_->Finish());
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchTraverseResponse>> stream_;
  bool ended_ = false;
};

class WatchStreamTest : public ::testing::Test {
 protected:
  WatchStreamTest() {
    for (uint64_t i = 0; i < kNumEvents; ++i) traverses_.Register(i);
  }

  FakeTraverses traverses_;
  StreamServer server_{traverses_};
  std::unique_ptr<v1::TraverseService::Stub> stub_ = server_.NewStub();
};

TEST_F(WatchStreamTest, TellsWhatIsThereAndEnds) {
  Watcher all(*stub_, 0, true);
  all.Expect(0, kNumEvents);
  EXPECT_FALSE(all.Receive().has_value());
  EXPECT_THAT(all.End(), IsOk());
  Watcher none(*stub_, kNumEvents, true);
  EXPECT_FALSE(none.Receive().has_value());
  EXPECT_THAT(none.End(), IsOk());
}

TEST_F(WatchStreamTest, TellsWhatHappensLater) {
  Watcher watcher(*stub_, 0, false);
  watcher.Expect(0, kNumEvents);
  for (uint64_t i = kNumEvents; i < 2 * kNumEvents; ++i) {
    traverses_.Register(i);
    watcher.Expect(i, 1);
  }
}

TEST_F(WatchStreamTest, GoesOnAtAnEvent) {
  {
    Watcher first(*stub_, 0, false);
    first.Expect(0, 11);
  }
  Watcher second(*stub_, 11, false);
  second.Expect(11, kNumEvents - 11);
  traverses_.Register(kNumEvents);
  second.Expect(kNumEvents, 1);
}

TEST_F(WatchStreamTest, RefusesEventsBeyondTheNext) {
  Watcher watcher(*stub_, kNumEvents + 1, false);
  EXPECT_EQ(ReasonText(watcher.End()), "OFFSET_OUT_OF_RANGE");
}

TEST_F(WatchStreamTest, RefusesTraversesThatAreNot) {
  for (const bool existing_only : {false, true}) {
    Watcher watcher(*stub_, 0, existing_only, "traverses/other");
    EXPECT_EQ(ReasonText(watcher.End()), "TRAVERSE_NOT_FOUND");
  }
}

TEST_F(WatchStreamTest, EndsWhenTheTraverseIsDeleted) {
  Watcher watcher(*stub_, 0, false);
  watcher.Expect(0, kNumEvents);
  ASSERT_THAT(traverses_.Delete(FakeTraverses::kName), IsOk());
  const absl::Status end = watcher.End();
  EXPECT_THAT(end, HasCode(absl::StatusCode::kNotFound));
  EXPECT_EQ(ReasonText(end), "TRAVERSE_NOT_FOUND");
}

TEST_F(WatchStreamTest, LetsGoOfWatchersWhenTheServerDrains) {
  Watcher watcher(*stub_, 0, false);
  watcher.Expect(0, kNumEvents);
  server_.Drain();
  EXPECT_EQ(ReasonText(watcher.End()), "NOT_SERVING");
  Watcher late(*stub_, 0, false);
  EXPECT_EQ(ReasonText(late.End()), "NOT_SERVING");
}

TEST_F(WatchStreamTest, OutlivesWatchersThatDisappear) {
  for (int i = 0; i < 10; ++i) {
    Watcher watcher(*stub_, 0, false);
    watcher.Expect(0, i);
    traverses_.Register(kNumEvents + static_cast<uint64_t>(i));
  }
  EXPECT_TRUE(WaitUntil([&] { return server_.OpenCalls("WatchTraverse") == 0; }));
}

// One that reads nothing holds up nobody, and what it is not told yet stays where it is.
TEST_F(WatchStreamTest, BearsASlowWatcher) {
  Watcher slow(*stub_, 0, false);
  Watcher quick(*stub_, 0, false);
  quick.Expect(0, kNumEvents);
  for (uint64_t i = kNumEvents; i < 500; ++i) traverses_.Register(i);
  quick.Expect(kNumEvents, 500 - kNumEvents);
  slow.Expect(0, 500);
}

}  // namespace
}  // namespace curvereg::testing
