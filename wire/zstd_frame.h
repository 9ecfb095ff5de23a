// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes to and from one frame of zstd (RFC 8878), of which the size is known beforehand.
#ifndef CURVEREG_WIRE_ZSTD_FRAME_H_
#define CURVEREG_WIRE_ZSTD_FRAME_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace curvereg::wire {

// Bytes that are not set to zero first: pages of memory that nothing is written to are not taken from the system.
struct Buffer {
  explicit Buffer(size_t num_bytes) : data(new char[num_bytes]), size(num_bytes) {}
  std::string_view View() const { return {data.get(), size}; }

  std::unique_ptr<char[]> data;
  size_t size;
};

// Most bytes that DecompressFrame takes besides its result.
inline constexpr uint64_t kDecompressorBytes = 256 * 1024;

// One frame with content size and checksum. Levels out of zstd's range are cut to it. INTERNAL: zstd fails.
absl::StatusOr<std::string> CompressFrame(std::string_view bytes, int level);

// Exactly `size` bytes. MALFORMED_PAYLOAD: not one whole frame and nothing else, a frame that tells of or holds another
// number of bytes, needs a dictionary, or a window above 128 MiB (what zstd's own decoders refuse).
// Takes no memory for the result before the frame's headers have been looked at, and none beyond `size` ever.
absl::StatusOr<Buffer> DecompressFrame(std::string_view frame, size_t size);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_ZSTD_FRAME_H_
