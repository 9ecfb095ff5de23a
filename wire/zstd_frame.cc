// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/zstd_frame.h"

#include <zstd.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

absl::Status Malformed(std::string_view what) { return MakeError(v1::ERROR_REASON_MALFORMED_PAYLOAD, what); }

bool HasMagicNumber(std::string_view frame) { return frame.substr(0, 4) == "\x28\xB5\x2F\xFD"; }

// log2 of the window that the frame asks for, rounded up; 0 where the frame is one segment. RFC 8878, 3.1.1.1.2.
int WindowLog(std::string_view frame) {
  if (frame.size() < 6 || (static_cast<unsigned char>(frame[4]) & 0x20U) != 0) return 0;
  const auto descriptor = static_cast<unsigned char>(frame[5]);
  return 10 + (descriptor >> 3) + ((descriptor & 7U) != 0 ? 1 : 0);
}

// What can be known before anything is decompressed.
absl::Status ValidateFrame(std::string_view frame, size_t size) {
  constexpr int kMaxWindowLog = 27;
  if (!HasMagicNumber(frame)) return Malformed("payload is not a zstd frame");  // nor may it be a skippable one
  const size_t frame_bytes = ZSTD_findFrameCompressedSize(frame.data(), frame.size());
  if (ZSTD_isError(frame_bytes) != 0) return Malformed("payload is not a whole zstd frame");
  if (frame_bytes != frame.size()) return Malformed("payload has bytes after its zstd frame");
  const unsigned long long content_bytes = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (content_bytes == ZSTD_CONTENTSIZE_ERROR) return Malformed("payload is not a zstd frame");
  if (content_bytes != ZSTD_CONTENTSIZE_UNKNOWN && content_bytes != size) {
    return Malformed(absl::StrCat("zstd frame of ", content_bytes, " bytes; the header asks for ", size));
  }
  if (WindowLog(frame) > kMaxWindowLog) return Malformed("zstd frame asks for a window above 128 MiB");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> CompressFrame(std::string_view bytes, int level) {
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (context == nullptr) return absl::ResourceExhaustedError("no memory for zstd");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);  // cuts the level to its range
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  const Buffer frame(ZSTD_compressBound(bytes.size()));
  const size_t frame_bytes = ZSTD_compress2(context.get(), frame.data.get(), frame.size, bytes.data(), bytes.size());
  if (ZSTD_isError(frame_bytes) != 0) return absl::InternalError(ZSTD_getErrorName(frame_bytes));
  return std::string(frame.data.get(), frame_bytes);
}

absl::StatusOr<Buffer> DecompressFrame(std::string_view frame, size_t size) {
  if (absl::Status status = ValidateFrame(frame, size); !status.ok()) return status;
  const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  if (context == nullptr) return absl::ResourceExhaustedError("no memory for zstd");
  // The result is the window: zstd keeps no other, whatever the frame asks for.
  Buffer content(size);
  const size_t content_bytes =
      ZSTD_decompressDCtx(context.get(), content.data.get(), content.size, frame.data(), frame.size());
  if (ZSTD_isError(content_bytes) != 0) return Malformed(absl::StrCat("zstd: ", ZSTD_getErrorName(content_bytes)));
  if (content_bytes != size) {
    return Malformed(absl::StrCat("zstd frame holds ", content_bytes, " bytes; the header asks for ", size));
  }
  return content;
}

}  // namespace curvereg::wire
