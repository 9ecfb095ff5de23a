// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload_messages.h"

#include <grpcpp/support/slice.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "wire/digest.h"

namespace curvereg::internal {
namespace {

std::string BytesOf(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  EXPECT_TRUE(buffer.Dump(&slices).ok());
  std::string bytes;
  for (const grpc::Slice& slice : slices) bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return bytes;
}

TEST(SerializedChunkTest, IsTheMessageThatProtobufWouldWrite) {
  std::string bytes;
  for (int i = 0; i < 700'000; ++i) bytes.push_back(static_cast<char>(i * 31 % 251));
  const auto owner = std::make_shared<const std::string>(bytes);
  for (const uint64_t offset : {uint64_t{0}, uint64_t{1}, uint64_t{300'000}}) {
    for (const uint64_t size : {uint64_t{1}, uint64_t{127}, uint64_t{128}, uint64_t{16'384}, uint64_t{400'000}}) {
      for (const UploadPayload& payload : {UploadPayload{bytes, nullptr}, UploadPayload{*owner, owner}}) {
        v1::UploadScanRequest request;
        ASSERT_TRUE(request.ParseFromString(BytesOf(SerializedChunk(payload, offset, size)))) << offset << " " << size;
        ASSERT_TRUE(request.has_chunk());
        EXPECT_EQ(request.chunk().offset(), offset);
        EXPECT_EQ(request.chunk().data(), bytes.substr(offset, size));
        EXPECT_EQ(request.chunk().crc32c(), wire::Crc32c(bytes.substr(offset, size)));
      }
    }
  }
}

TEST(SerializedChunkTest, KeepsThePayloadAliveAndLetsItGo) {
  auto payload = std::make_shared<const std::string>(100'000, 'p');
  const std::weak_ptr<const std::string> watched = payload;
  {
    const grpc::ByteBuffer message = SerializedChunk({*payload, payload}, 10, 90'000);
    payload.reset();
    EXPECT_FALSE(watched.expired());
    v1::UploadScanRequest request;
    ASSERT_TRUE(request.ParseFromString(BytesOf(message)));
    EXPECT_EQ(request.chunk().data(), std::string(90'000, 'p'));
  }
  EXPECT_TRUE(watched.expired());
}

TEST(SerializedChunkTest, BorrowsAndWaitsForTheRelease) {
  std::string bytes(100'000, 'p');
  std::atomic<bool> is_released = false;
  BorrowedSlices borrowed;
  std::optional<grpc::ByteBuffer> message = SerializedChunk({bytes, nullptr, &borrowed}, 10, 90'000);
  std::jthread waiting([&] {
    borrowed.AwaitRelease();
    is_released = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(is_released);
  bytes[10] = 'q';  // seen by the message: it is no copy
  EXPECT_NE(BytesOf(*message).find("qp"), std::string::npos);
  message.reset();
  waiting.join();
  EXPECT_TRUE(is_released);
}

TEST(SerializedChunkTest, CopiesWhatItDoesNotOwn) {
  std::string bytes(100'000, 'p');
  const grpc::ByteBuffer message = SerializedChunk({bytes, nullptr}, 10, 90'000);
  bytes.assign(bytes.size(), 'q');
  v1::UploadScanRequest request;
  ASSERT_TRUE(request.ParseFromString(BytesOf(message)));
  EXPECT_EQ(request.chunk().data(), std::string(90'000, 'p'));
}

TEST(SerializedRequestTest, IsTheRequest) {
  v1::UploadScanRequest request;
  request.mutable_start()->set_upload("uploads/a");
  v1::UploadScanRequest read;
  ASSERT_TRUE(read.ParseFromString(BytesOf(SerializedRequest(request))));
  EXPECT_EQ(read.start().upload(), "uploads/a");
}

}  // namespace
}  // namespace curvereg::internal
