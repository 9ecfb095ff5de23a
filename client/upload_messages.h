// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// UploadScanRequest as bytes for gRPC. Chunks are not copied: the message refers to the payload, which lives as long as
// a message does.
#ifndef CURVEREG_CLIENT_UPLOAD_MESSAGES_H_
#define CURVEREG_CLIENT_UPLOAD_MESSAGES_H_

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <memory>
#include <string>

#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::internal {

grpc::ByteBuffer SerializedRequest(const v1::UploadScanRequest& request);

// The request whose chunk is bytes [offset, offset + size) of the payload, with their CRC-32C.
grpc::ByteBuffer SerializedChunk(const std::shared_ptr<const std::string>& payload, uint64_t offset, uint64_t size);

}  // namespace curvereg::internal

#endif  // CURVEREG_CLIENT_UPLOAD_MESSAGES_H_
