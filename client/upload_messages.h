// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// UploadScanRequest as bytes for gRPC.
#ifndef CURVEREG_CLIENT_UPLOAD_MESSAGES_H_
#define CURVEREG_CLIENT_UPLOAD_MESSAGES_H_

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "client/borrowed_slices.h"
#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::internal {

// The bytes to send. gRPC may hold a message longer than its call. So messages refer to the bytes and share the owner,
// where there is one; refer to the caller's bytes and are counted in `borrowed`, where that is given; else copy them.
struct UploadPayload {
  std::string_view bytes;
  std::shared_ptr<const std::string> owner;
  BorrowedSlices* borrowed = nullptr;
};

grpc::ByteBuffer SerializedRequest(const v1::UploadScanRequest& request);

// The request whose chunk is bytes [offset, offset + size) of the payload, with their CRC-32C.
grpc::ByteBuffer SerializedChunk(const UploadPayload& payload, uint64_t offset, uint64_t size);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_UPLOAD_MESSAGES_H_
