// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/download.h"

#include <algorithm>
#include <cstdint>

#include "client/download_stream.h"
#include "client/retry.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/point_codec.h"

namespace curvereg::internal {
namespace {

constexpr uint32_t kLeastChunkBytes = 16 * 1024;

// After an attempt that brought nothing. On a slow link it may be that no chunk came whole before the server was taken
// for silent, and then none ever would.
uint32_t LessThan(uint32_t chunk_bytes) {
  if (chunk_bytes != 0 && chunk_bytes <= kLeastChunkBytes) return chunk_bytes;
  return std::max(kLeastChunkBytes, chunk_bytes / 4);
}

}  // namespace

absl::StatusOr<Scan> DownloadScan(Connection& connection, const std::string& name, const TransferOptions& options) {
  const ClientOptions& settings = connection.options();
  Retrier retrier(connection, {options.cancellation, settings.call_timeout, IsResumable});
  DownloadState state;
  uint32_t chunk_bytes = options.chunk_bytes;
  const auto on_progress = [&](uint64_t num_bytes) {
    retrier.NoteProgress();
    if (options.progress) {
      options.progress({num_bytes, state.scan->payload_bytes(), 0, retrier.num_attempts() - 1});
    }
  };
  const absl::Status status = retrier.Run([&](const std::shared_ptr<grpc::Channel>& channel) {
    v1::DownloadScanRequest request;
    request.set_name(name);
    request.set_offset(state.payload.size());
    request.set_chunk_bytes(chunk_bytes);
    const absl::Status ended = DownloadStream(request, state)
                                   .Run(connection, channel, settings.keepalive_interval + settings.keepalive_timeout,
                                        options.cancellation, on_progress);
    if (state.payload.size() == request.offset()) chunk_bytes = LessThan(chunk_bytes);
    return ended;
  });
  if (!status.ok()) return status;
  if (!wire::SameDigest(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, state.payload), state.scan->payload_digest())) {
    return wire::MakeError(v1::ERROR_REASON_DIGEST_MISMATCH, "the downloaded scan does not have its digest");
  }
  return wire::DecodeScan(state.scan->header(), state.payload, {});
}

}  // namespace curvereg::internal
