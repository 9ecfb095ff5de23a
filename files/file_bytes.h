// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Reading a file whole, and numbers out of raw bytes. Read, not mapped: a mapped file that shrinks while it is read
// would end the process (SIGBUS).
#ifndef CURVEREG_FILES_FILE_BYTES_H_
#define CURVEREG_FILES_FILE_BYTES_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg {

static_assert(std::endian::native == std::endian::little, "the readers and writers copy little-endian numbers");

// The bytes of one file, owned. Immutable once read.
class FileBytes {
 public:
  FileBytes() = default;
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  friend absl::StatusOr<FileBytes> ReadFileBytes(const std::string&, uint64_t, const std::function<void(double)>&);
  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
};

// Reads `path` (a file, or a pipe to its end). `progress`, if not empty, is called with the share read in [0, 1].
// NOT_FOUND, PERMISSION_DENIED, INVALID_ARGUMENT (a folder), RESOURCE_EXHAUSTED (more than max_bytes, or no memory),
// DATA_LOSS (read error); the message names the file and the cause.
absl::StatusOr<FileBytes> ReadFileBytes(const std::string& path, uint64_t max_bytes,
                                        const std::function<void(double)>& progress = {});

// The same status with "path: " before its message; OK stays OK.
absl::Status WithPath(const std::string& path, const absl::Status& status);

// "path: action: No space left on device" with the canonical code of `error_number`.
absl::Status ErrnoStatus(const std::string& path, absl::string_view action, int error_number);

// The number at `bytes`, which need not be aligned.
template <typename T>
T LoadLittleEndian(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <typename T>
T LoadBigEndian(const char* bytes) {
  char reversed[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) reversed[i] = bytes[sizeof(T) - 1 - i];
  return LoadLittleEndian<T>(reversed);
}

}  // namespace curvereg

#endif  // CURVEREG_FILES_FILE_BYTES_H_
