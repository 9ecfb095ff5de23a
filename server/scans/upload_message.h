// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The messages of an upload stream as gRPC has them. Protobuf would copy each chunk once more; here it is read where it
// was received.
#ifndef CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_
#define CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "curvereg/v1/scan_service.pb.h"

namespace curvereg::server {

// Moving it leaves the data where it is; copying would not.
class UploadMessage {
 public:
  UploadMessage() = default;
  UploadMessage(UploadMessage&&) noexcept = default;
  UploadMessage& operator=(UploadMessage&&) noexcept = default;
  // As if it had been received. The data of a chunk stays in the request.
  explicit UploadMessage(v1::UploadScanRequest request);

  // False: not an UploadScanRequest. What the message held before is gone either way.
  bool Parse(const grpc::ByteBuffer& buffer);
  void Clear();

  v1::UploadScanRequest& request() { return request_; }  // of a chunk all but the data, which may be missing
  const v1::UploadScanRequest& request() const { return request_; }
  // The data of a chunk, in pieces, none empty. Valid until the next Parse or Clear.
  const std::vector<std::string_view>& chunk_data() const { return chunk_data_; }
  // CRC-32C of the data as it is. Computed at once, so by Parse, which runs while the disk pool has the message before.
  uint32_t chunk_crc32c() const { return chunk_crc32c_; }

 private:
  void FindDataInRequest();
  void SumData();

  v1::UploadScanRequest request_;
  std::vector<grpc::Slice> slices_;  // small ones hold their bytes themselves: not to be copied
  std::vector<std::string_view> chunk_data_;
  uint32_t chunk_crc32c_ = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_UPLOAD_MESSAGE_H_
