// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A message of an upload stream. Protobuf would copy the data of each chunk; here it is read where gRPC received it.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::server {

// Can be moved, which leaves the data of a chunk where it is, but not copied.
class UploadMessage {
 public:
  UploadMessage() = default;
  UploadMessage(UploadMessage&&) noexcept = default;
  UploadMessage& operator=(UploadMessage&&) noexcept = default;

  // Takes the place of what the message held before. False: the bytes are no UploadScanRequest.
  bool Parse(const grpc::ByteBuffer& buffer);
  void Clear();

  // The request; that of a chunk may be without its data.
  v1::UploadScanRequest& request() { return request_; }
  const v1::UploadScanRequest& request() const { return request_; }
  // The data of a chunk, in pieces, none empty. Valid until the next Parse or Clear.
  const std::vector<std::string_view>& chunk_data() const { return chunk_data_; }
  // CRC-32C of the data as received. Computed by Parse, which runs while the disk pool works on the message before.
  uint32_t chunk_crc32c() const { return chunk_crc32c_; }

 private:
  void FindDataInRequest();
  void ComputeCrc();

  v1::UploadScanRequest request_;
  std::vector<grpc::Slice> slices_;  // the bytes received; a small slice holds its bytes in itself
  std::vector<std::string_view> chunk_data_;
  uint32_t chunk_crc32c_ = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_
