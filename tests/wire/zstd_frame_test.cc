// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/zstd_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/testing/matchers.h"
#include "wire/cloud_header.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsOk;
using ::testing::HasSubstr;

std::string SomeBytes(size_t size) {
  std::string bytes(size, '\0');
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(((i * 2654435761U) >> 13) & 0x3FU);
  return bytes;
}

std::string Frame(std::string_view bytes) { return *CompressFrame(bytes, 1); }

// Of an answer that must be MALFORMED_PAYLOAD.
std::string MessageOf(const absl::StatusOr<Buffer>& result) {
  EXPECT_EQ(ReasonOf(result.status()), v1::ERROR_REASON_MALFORMED_PAYLOAD);
  return std::string(result.status().message());
}

TEST(ZstdFrameTest, GivesTheBytesBackAtEveryLevel) {
  for (const size_t size : {size_t{0}, size_t{1}, size_t{1000}, size_t{1} << 20}) {
    const std::string bytes = SomeBytes(size);
    for (const int level : {-1'000'000, 0, 1, 3, 1000}) {
      if (level == 1000 && size > 1000) continue;  // cut to 22, which is slow
      const absl::StatusOr<std::string> frame = CompressFrame(bytes, level);
      ASSERT_THAT(frame, IsOk());
      const absl::StatusOr<Buffer> back = DecompressFrame(*frame, size);
      ASSERT_THAT(back, IsOk());
      EXPECT_EQ(back->View(), bytes);
    }
  }
}

TEST(ZstdFrameTest, RefusesAnotherSizeThanAskedFor) {
  const std::string frame = Frame(SomeBytes(1000));
  EXPECT_THAT(MessageOf(DecompressFrame(frame, 999)), HasSubstr("frame of 1000 bytes; the header asks for 999"));
  EXPECT_THAT(MessageOf(DecompressFrame(frame, 1001)), HasSubstr("frame of 1000 bytes"));
}

TEST(ZstdFrameTest, RefusesWhatIsNotOneWholeFrame) {
  const std::string frame = Frame(SomeBytes(1000));
  for (size_t size = 0; size < frame.size(); ++size) {
    ASSERT_FALSE(DecompressFrame(frame.substr(0, size), 1000).ok()) << size << " of " << frame.size() << " bytes";
  }
  EXPECT_THAT(MessageOf(DecompressFrame(frame + "x", 1000)), HasSubstr("bytes after"));
  EXPECT_THAT(MessageOf(DecompressFrame(Frame(SomeBytes(500)) + Frame(SomeBytes(500)), 1000)), HasSubstr("after"));
  const std::string skippable("\x50\x2A\x4D\x18\x04\0\0\0abcd", 12);
  EXPECT_THAT(MessageOf(DecompressFrame(skippable, 0)), HasSubstr("not a zstd frame"));
  EXPECT_THAT(MessageOf(DecompressFrame(skippable + frame, 1000)), HasSubstr("not a zstd frame"));
}

// The checksum meets what the format itself does not.
TEST(ZstdFrameTest, NoChangedByteGivesOtherBytes) {
  const std::string bytes = SomeBytes(3000);
  const std::string frame = Frame(bytes);
  int num_refused = 0;
  for (size_t i = 0; i < frame.size(); ++i) {
    for (const unsigned flip : {0x01U, 0x20U, 0x80U}) {
      std::string changed = frame;
      changed[i] = static_cast<char>(static_cast<unsigned char>(changed[i]) ^ flip);
      const absl::StatusOr<Buffer> result = DecompressFrame(changed, bytes.size());
      num_refused += result.ok() ? 0 : 1;
      EXPECT_TRUE(!result.ok() || result->View() == bytes) << "byte " << i;
    }
  }
  EXPECT_GT(num_refused, static_cast<int>(2 * frame.size()));
}

// As a client that compresses while it reads writes it.
std::string FrameOfUnknownSize(std::string_view bytes, int window_log) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_windowLog, window_log);
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  ZSTD_outBuffer out{frame.data(), frame.size(), 0};
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_compressStream2(context, &out, &in, ZSTD_e_continue);
  ZSTD_compressStream2(context, &out, &in, ZSTD_e_end);
  ZSTD_freeCCtx(context);
  return frame.substr(0, out.pos);
}

TEST(ZstdFrameTest, TakesFramesThatDoNotTellTheirSize) {
  const std::string bytes = SomeBytes(300'000);
  const std::string frame = FrameOfUnknownSize(bytes, 18);
  ASSERT_EQ(ZSTD_getFrameContentSize(frame.data(), frame.size()), ZSTD_CONTENTSIZE_UNKNOWN);
  const absl::StatusOr<Buffer> back = DecompressFrame(frame, bytes.size());
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->View(), bytes);
  EXPECT_THAT(MessageOf(DecompressFrame(frame, bytes.size() + 1)), HasSubstr("holds 300000 bytes"));
  MessageOf(DecompressFrame(frame, bytes.size() - 1));
}

// A frame of one raw block of 3 bytes whose window descriptor is `descriptor`. RFC 8878, 3.1.1.
std::string FrameWithWindow(unsigned char descriptor) {
  return std::string("\x28\xB5\x2F\xFD\x00", 5) + static_cast<char>(descriptor) + std::string("\x19\0\0abc", 6);
}

TEST(ZstdFrameTest, RefusesWindowsThatOtherDecodersRefuse) {
  EXPECT_THAT(DecompressFrame(FrameWithWindow(17 << 3), 3), IsOk());
  EXPECT_THAT(MessageOf(DecompressFrame(FrameWithWindow(17 << 3 | 1), 3)), HasSubstr("window"));
  EXPECT_THAT(MessageOf(DecompressFrame(FrameWithWindow(18 << 3), 3)), HasSubstr("window"));
}

// The densest frame there is: blocks that repeat one byte. The ratio is what ValidateHeader goes by.
TEST(ZstdFrameTest, ABombBurstsAtTheSizeAskedFor) {
  constexpr size_t kBlock = 128 * 1024;
  constexpr int kNumBlocks = 1000;
  std::string bomb("\x28\xB5\x2F\xFD\x00\x38", 6);  // a window of 128 KiB, no content size
  for (int i = 0; i < kNumBlocks; ++i) {
    const uint32_t header = (kBlock << 3) | (1U << 1) | (i + 1 == kNumBlocks ? 1U : 0U);
    for (int shift = 0; shift < 24; shift += 8) bomb.push_back(static_cast<char>(header >> shift));
    bomb.push_back('\0');
  }
  EXPECT_LE(kNumBlocks * kBlock / bomb.size(), kMaxZstdRatio);
  EXPECT_THAT(DecompressFrame(bomb, kNumBlocks * kBlock), IsOk());
  for (const size_t size : {size_t{0}, size_t{12}, kBlock, kNumBlocks * kBlock - 1}) {
    EXPECT_THAT(MessageOf(DecompressFrame(bomb, size)), HasSubstr("zstd: ")) << size;
  }
}

TEST(ZstdFrameTest, TheDecompressorStaysWithinItsBound) {
  ZSTD_DCtx* context = ZSTD_createDCtx();
  const std::string bytes = SomeBytes(1 << 20);
  const std::string frame = Frame(bytes);
  std::string out(bytes.size(), '\0');
  ASSERT_EQ(ZSTD_decompressDCtx(context, out.data(), out.size(), frame.data(), frame.size()), bytes.size());
  EXPECT_LE(ZSTD_sizeof_DCtx(context), kDecompressorBytes);
  ZSTD_freeDCtx(context);
}

}  // namespace
}  // namespace curvereg::wire
