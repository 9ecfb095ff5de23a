// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload_messages.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <grpcpp/support/slice.h>

#include <array>
#include <string>

#include "wire/digest.h"

namespace curvereg::internal {
namespace {

// Wire type 2: a length, then as many bytes.
constexpr uint32_t LengthDelimitedTag(int field_number) { return static_cast<uint32_t>(field_number) << 3 | 2U; }

grpc::Slice SliceOf(const UploadPayload& payload, uint64_t offset, uint64_t size) {
  if (payload.owner == nullptr) {
    const std::string_view bytes = payload.bytes.substr(offset, size);
    return payload.borrowed == nullptr ? grpc::Slice(bytes.data(), bytes.size()) : payload.borrowed->Borrow(bytes);
  }
  auto* keeper = new std::shared_ptr<const std::string>(payload.owner);
  // gRPC takes a pointer to non-const and does not write through it.
  return grpc::Slice(
      const_cast<char*>(payload.bytes.data()) + offset, size,
      [](void* owner) { delete static_cast<std::shared_ptr<const std::string>*>(owner); }, keeper);
}

}  // namespace

grpc::ByteBuffer SerializedRequest(const v1::UploadScanRequest& request) {
  const grpc::Slice slice(request.SerializeAsString());
  return {&slice, 1};
}

grpc::ByteBuffer SerializedChunk(const UploadPayload& payload, uint64_t offset, uint64_t size) {
  // The chunk without its data; a field may stand anywhere in a message, so the data comes last.
  v1::PayloadChunk chunk;
  chunk.set_offset(offset);
  chunk.set_crc32c(wire::Crc32c(payload.bytes.substr(offset, size)));
  const std::string fields = chunk.SerializeAsString();
  std::string data_head;
  std::string head;
  {
    google::protobuf::io::StringOutputStream text(&data_head);
    google::protobuf::io::CodedOutputStream out(&text);
    out.WriteTag(LengthDelimitedTag(v1::PayloadChunk::kDataFieldNumber));
    out.WriteVarint32(static_cast<uint32_t>(size));
  }
  {
    google::protobuf::io::StringOutputStream text(&head);
    google::protobuf::io::CodedOutputStream out(&text);
    out.WriteTag(LengthDelimitedTag(v1::UploadScanRequest::kChunkFieldNumber));
    out.WriteVarint32(static_cast<uint32_t>(fields.size() + data_head.size() + size));
  }
  const std::array<grpc::Slice, 2> slices = {grpc::Slice(head + fields + data_head), SliceOf(payload, offset, size)};
  return {slices.data(), slices.size()};
}

}  // namespace curvereg::internal
