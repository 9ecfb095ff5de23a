// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_message.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "wire/digest.h"

namespace curvereg::server {
namespace {

using google::protobuf::util::MessageDifferencer;

// `bytes` in slices of `slice_bytes`.
grpc::ByteBuffer Cut(const std::string& bytes, std::size_t slice_bytes) {
  std::vector<grpc::Slice> slices;
  for (std::size_t i = 0; i < bytes.size(); i += slice_bytes) slices.emplace_back(bytes.substr(i, slice_bytes));
  return {slices.data(), slices.size()};
}

std::string DataOf(const UploadMessage& message) {
  std::string data;
  for (const std::string_view piece : message.chunk_data()) data += piece;
  return data;
}

v1::UploadScanRequest Chunk(const std::string& data) {
  v1::UploadScanRequest request;
  request.mutable_chunk()->set_offset(uint64_t{1} << 40);
  request.mutable_chunk()->set_crc32c(wire::Crc32c(data));
  request.mutable_chunk()->set_data(data);
  return request;
}

std::string SomeBytes(std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<char>(i * 31 % 251));
  return bytes;
}

// Against protobuf; true: both read it, and alike.
bool ReadsAsProtobuf(const std::string& bytes, std::size_t slice_bytes) {
  v1::UploadScanRequest expected;
  const bool is_valid = expected.ParseFromString(bytes);
  UploadMessage message;
  EXPECT_EQ(message.Parse(Cut(bytes, slice_bytes)), is_valid) << bytes.size() << " " << slice_bytes;
  if (!is_valid) return false;
  EXPECT_EQ(DataOf(message), expected.chunk().data());
  EXPECT_EQ(message.chunk_crc32c(), wire::Crc32c(expected.chunk().data()));
  v1::UploadScanRequest rest = message.request();
  if (rest.has_chunk()) rest.mutable_chunk()->set_data(expected.chunk().data());
  EXPECT_TRUE(MessageDifferencer::Equals(rest, expected)) << rest.DebugString();
  return true;
}

TEST(UploadMessageTest, ReadsChunksHoweverTheyAreCut) {
  for (const std::size_t size : {0, 1, 127, 128, 5000}) {
    const std::string bytes = Chunk(SomeBytes(size)).SerializeAsString();
    for (const std::size_t slice_bytes : {1, 2, 3, 7, 30, 1000, 100'000}) {
      EXPECT_TRUE(ReadsAsProtobuf(bytes, slice_bytes)) << size << " " << slice_bytes;
    }
  }
}

TEST(UploadMessageTest, DoesNotCopyAChunk) {
  const std::string bytes = Chunk(SomeBytes(5000)).SerializeAsString();
  UploadMessage message;
  ASSERT_TRUE(message.Parse(Cut(bytes, bytes.size())));
  EXPECT_EQ(message.chunk_data().size(), 1U);
  EXPECT_TRUE(message.request().chunk().data().empty());
}

TEST(UploadMessageTest, KeepsTheDataWhenMoved) {
  for (const std::size_t slice_bytes : {3, 20, 4000}) {
    const std::string data = SomeBytes(5000);
    UploadMessage first;
    ASSERT_TRUE(first.Parse(Cut(Chunk(data).SerializeAsString(), slice_bytes)));
    std::vector<UploadMessage> messages;
    messages.push_back(std::move(first));
    messages.emplace_back();
    messages.emplace_back();
    EXPECT_EQ(DataOf(messages.front()), data);
  }
}

// What protobuf allows besides: fields that come twice, in another order, or that nobody knows.
TEST(UploadMessageTest, LeavesTheUnusualToProtobuf) {
  v1::UploadScanRequest start;
  start.mutable_start()->set_upload("uploads/a");
  v1::UploadScanRequest finish;
  finish.mutable_finish();
  const std::string chunk = Chunk("abc").SerializeAsString();
  const std::string unknown("\x7a\x01x", 3);                   // field 15
  const std::string unknown_in_chunk("\x12\x03\x7a\x01x", 5);  // `chunk` with field 15 alone
  const std::string data_twice("\x12\x08\x12\x02hi\x12\x02yo", 10);
  const std::vector<std::string> all = {"",
                                        start.SerializeAsString(),
                                        finish.SerializeAsString(),
                                        chunk + Chunk("de").SerializeAsString(),
                                        chunk + start.SerializeAsString(),
                                        start.SerializeAsString() + chunk,
                                        chunk + unknown,
                                        unknown + chunk,
                                        chunk + unknown_in_chunk,
                                        unknown_in_chunk,
                                        data_twice};
  for (const std::string& bytes : all) {
    EXPECT_TRUE(ReadsAsProtobuf(bytes, 2)) << bytes.size();
    EXPECT_TRUE(ReadsAsProtobuf(bytes, 1000)) << bytes.size();
  }
}

TEST(UploadMessageTest, RefusesWhatIsNoRequest) {
  const std::string chunk = Chunk(SomeBytes(300)).SerializeAsString();
  for (std::size_t size = 1; size < chunk.size(); ++size) {
    EXPECT_FALSE(ReadsAsProtobuf(chunk.substr(0, size), 50)) << size;
  }
  EXPECT_FALSE(ReadsAsProtobuf(chunk + '\0', 50));
  EXPECT_FALSE(ReadsAsProtobuf("\x12\xff\xff\xff\xff\x0f", 50));  // a size beyond 2^31
  for (std::size_t i = 0; i < 12; ++i) {
    for (int value = 0; value < 256; ++value) {
      std::string spoiled = chunk;
      spoiled[i] = static_cast<char>(value);
      SCOPED_TRACE(testing::Message() << "byte " << i << " is " << value);
      ReadsAsProtobuf(spoiled, 7);  // the same as protobuf, whatever that is
    }
  }
}

// Nothing is left of the message before.
TEST(UploadMessageTest, ForgetsTheMessageBefore) {
  UploadMessage message;
  ASSERT_TRUE(message.Parse(Cut(Chunk("abc").SerializeAsString(), 100)));
  v1::UploadScanRequest finish;
  finish.mutable_finish();
  ASSERT_TRUE(message.Parse(Cut(finish.SerializeAsString(), 100)));
  EXPECT_TRUE(message.request().has_finish());
  EXPECT_TRUE(message.chunk_data().empty());
  EXPECT_EQ(message.chunk_crc32c(), 0U);
}

}  // namespace
}  // namespace curvereg::server
