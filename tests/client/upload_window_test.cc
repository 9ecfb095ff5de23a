// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload_window.h"

#include <algorithm>
#include <deque>

#include <gtest/gtest.h>

namespace curvereg::internal {
namespace {

using std::chrono::milliseconds;

constexpr uint64_t kKiB = 1024;
constexpr uint64_t kMiB = 1024 * kKiB;

TEST(UploadWindowTest, BeginsAtTheShareButNotBelowTheLeast) {
  EXPECT_EQ(UploadWindow({.share_base_bytes = 3'000'000}).bytes(), 64 * kKiB);
  EXPECT_EQ(UploadWindow({.share_base_bytes = 100'000'000}).bytes(), 2'000'000U);
  EXPECT_EQ(UploadWindow({.share_base_bytes = 10'000'000, .max_resend_share = 0.5}).bytes(), 5'000'000U);
  EXPECT_EQ(UploadWindow({.share_base_bytes = 0}).bytes(), 64 * kKiB);
}

TEST(UploadWindowTest, ChunksAreAQuarterOfItAndFillIt) {
  const UploadWindow window({.share_base_bytes = 3'000'000});
  const uint64_t payload = 3'000'000;
  EXPECT_EQ(window.NextChunkBytes(0, 0, payload), 16 * kKiB);
  EXPECT_EQ(window.NextChunkBytes(48 * kKiB, 0, payload), 16 * kKiB);
  EXPECT_EQ(window.NextChunkBytes(64 * kKiB, 0, payload), 0U);
  EXPECT_EQ(window.NextChunkBytes(64 * kKiB, 16 * kKiB, payload), 16 * kKiB);
  EXPECT_EQ(window.NextChunkBytes(payload - 5, payload - 5, payload), 5U);
  const UploadWindow small({.share_base_bytes = 3'000'000, .max_chunk_bytes = 1000});
  EXPECT_EQ(small.NextChunkBytes(0, 0, payload), 1000U);
}

// A link that acknowledges each chunk `delay` after it was sent; sends `payload` bytes, tells the greatest window.
struct Sent {
  uint64_t most_under_way = 0;
  uint64_t greatest_chunk = 0;
  uint64_t window = 0;
};
Sent SendOver(UploadWindow& window, milliseconds delay, uint64_t payload) {
  Sent sent;
  UploadWindow::TimePoint now{};
  std::deque<uint64_t> ends;
  uint64_t offset = 0;
  uint64_t committed = 0;
  while (committed < payload) {
    for (uint64_t size = 0; (size = window.NextChunkBytes(offset, committed, payload)) > 0;) {
      offset += size;
      window.Sent(offset, now);
      ends.push_back(offset);
      sent.greatest_chunk = std::max(sent.greatest_chunk, size);
      sent.most_under_way = std::max(sent.most_under_way, offset - committed);
    }
    now += delay;  // all that is under way comes back
    committed = ends.back();
    ends.clear();
    window.Acknowledged(committed, now);
  }
  sent.window = window.bytes();
  return sent;
}

TEST(UploadWindowTest, GrowsWhereAcknowledgementsComeAtOnce) {
  UploadWindow window({.share_base_bytes = 200 * kMiB});
  const Sent sent = SendOver(window, milliseconds(2), 200 * kMiB);
  EXPECT_EQ(sent.window, 16 * kMiB);
  EXPECT_EQ(sent.greatest_chunk, 512 * kKiB);
}

TEST(UploadWindowTest, StaysAtTheShareOnALongLink) {
  UploadWindow window({.share_base_bytes = 3'000'000});
  const Sent sent = SendOver(window, milliseconds(600), 3'000'000);
  EXPECT_EQ(sent.window, 64 * kKiB);
  EXPECT_LE(sent.most_under_way, 64 * kKiB);
  EXPECT_EQ(sent.greatest_chunk, 16 * kKiB);
}

TEST(UploadWindowTest, GoesBackWhenTheLinkTurnsSlow) {
  UploadWindow window({.share_base_bytes = 3'000'000});
  SendOver(window, milliseconds(2), 10 * kMiB);
  EXPECT_GT(window.bytes(), kMiB);
  UploadWindow::TimePoint now{};
  window.Sent(20 * kMiB, now);
  window.Acknowledged(20 * kMiB, now + milliseconds(600));
  EXPECT_EQ(window.bytes(), 64 * kKiB);
}

TEST(UploadWindowTest, OneSlowAcknowledgementInARoundKeepsItFromGrowing) {
  UploadWindow window({.share_base_bytes = 3'000'000});
  const UploadWindow::TimePoint now{};
  window.Sent(16 * kKiB, now);
  window.Sent(32 * kKiB, now);
  window.Acknowledged(16 * kKiB, now + milliseconds(1));  // ends the round of one chunk
  EXPECT_EQ(window.bytes(), 128 * kKiB);
  window.Acknowledged(32 * kKiB, now + milliseconds(100));
  EXPECT_EQ(window.bytes(), 128 * kKiB);
}

}  // namespace
}  // namespace curvereg::internal
