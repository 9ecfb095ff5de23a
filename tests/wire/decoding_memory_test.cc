// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The server reserves DecodingBytes before it decodes, so decoding must not take more, whatever the bytes say. Counts
// what operator new gives out; zstd's own memory is bounded in zstd_frame_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/point_layout.h"
#include "wire/zstd_frame.h"

namespace {

std::atomic<size_t> live_bytes{0};
std::atomic<size_t> peak_bytes{0};

}  // namespace

// Out of line, for the compiler takes malloc and operator delete for a mismatch where it sees both.
[[gnu::noinline]] void* operator new(size_t size) {
  void* memory = std::malloc(size);
  if (memory == nullptr) std::abort();
  const size_t live = live_bytes += malloc_usable_size(memory);
  if (live > peak_bytes) peak_bytes = live;
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  live_bytes -= malloc_usable_size(memory);
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t /*size*/) noexcept { operator delete(memory); }

namespace curvereg::wire {
namespace {

constexpr uint64_t kSmall = 64 * 1024;  // texts of errors, rounding of sizes by malloc

struct Outcome {
  absl::Status status;
  size_t bytes = 0;  // most that was taken at a time
};

Outcome Decode(const v1::PointCloud& cloud) {
  const size_t before = live_bytes;
  peak_bytes = before;
  Outcome outcome;
  outcome.status = DecodeScan(cloud.header(), cloud.data(), {}).status();
  outcome.bytes = peak_bytes - before;
  return outcome;
}

v1::PointCloud Encoded(v1::PointEncoding encoding, size_t num_points) {
  Scan scan;
  for (size_t i = 0; i < num_points; ++i) {
    const auto number = static_cast<float>(i);
    scan.points.emplace_back(0.01F * number, -0.02F * number, static_cast<float>(i % 1000));
  }
  PointEncodingOptions options;
  options.encoding = encoding;
  return *EncodeScan(scan, options);
}

TEST(DecodingMemoryTest, DecodingBytesAreEnough) {
  for (const auto encoding :
       {v1::POINT_ENCODING_RAW, v1::POINT_ENCODING_SHUFFLED_ZSTD, v1::POINT_ENCODING_QUANTIZED_ZSTD}) {
    const v1::PointCloud cloud = Encoded(encoding, 300'000);
    const Outcome outcome = Decode(cloud);
    EXPECT_TRUE(outcome.status.ok()) << outcome.status;
    EXPECT_LE(outcome.bytes, DecodingBytes(cloud.header()) + kSmall) << encoding;
    EXPECT_GE(outcome.bytes, 12U * 300'000) << "or nothing was counted";
  }
}

// A frame that tells its size is believed only when it is the header's: nothing is taken for it otherwise.
TEST(DecodingMemoryTest, ALyingHeaderTakesNothing) {
  for (const auto encoding : {v1::POINT_ENCODING_SHUFFLED_ZSTD, v1::POINT_ENCODING_QUANTIZED_ZSTD}) {
    v1::PointCloud cloud = Encoded(encoding, 50'000);
    cloud.mutable_header()->set_point_count(5'000'000);
    const Outcome outcome = Decode(cloud);
    EXPECT_EQ(ReasonOf(outcome.status), v1::ERROR_REASON_MALFORMED_PAYLOAD);
    EXPECT_LE(outcome.bytes, kSmall);
  }
}

// Few points in the header, a payload that bursts.
TEST(DecodingMemoryTest, ABombTakesWhatItsHeaderDeclares) {
  v1::PointCloud cloud = Encoded(v1::POINT_ENCODING_SHUFFLED_ZSTD, 100);
  cloud.set_data(*CompressFrame(std::string(size_t{64} << 20, '\0'), 1));
  ASSERT_LT(cloud.data().size(), 20'000U);
  Outcome outcome = Decode(cloud);
  EXPECT_EQ(ReasonOf(outcome.status), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  EXPECT_LE(outcome.bytes, kSmall);
  std::string& frame = *cloud.mutable_data();
  ASSERT_EQ(frame[4] & 0x20, 0) << "has a window descriptor";
  ASSERT_EQ(static_cast<unsigned char>(frame[4]) >> 6, 2) << "has a content size of 4 bytes";
  frame.erase(6, 4);  // the same frame, its content size untold
  frame[4] = static_cast<char>(frame[4] & 0x3F);
  outcome = Decode(cloud);
  EXPECT_EQ(ReasonOf(outcome.status), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  EXPECT_LE(outcome.bytes, DecodingBytes(cloud.header()) + kSmall);
}

}  // namespace
}  // namespace curvereg::wire
