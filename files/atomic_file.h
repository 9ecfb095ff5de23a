// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A file that appears whole or not at all.
#ifndef CURVEREG_FILES_ATOMIC_FILE_H_
#define CURVEREG_FILES_ATOMIC_FILE_H_

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg {

// Bytes go to a temporary beside the target; Commit() forces them to disk and renames. Without a Commit() that
// succeeds the temporary is removed and whatever was at `path` before stays as it was. A link is followed; a device or
// pipe (/dev/stdout) is written to directly. Not for use by two threads.
class AtomicFile {
 public:
  // Errors name the file and the cause: NOT_FOUND (no such folder), PERMISSION_DENIED, INVALID_ARGUMENT (a folder).
  static absl::StatusOr<AtomicFile> Create(const std::string& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) = delete;
  ~AtomicFile();

  // The first failure is kept and returned by Commit(); later bytes are dropped.
  void Append(std::string_view bytes);

  // Makes the file appear. RESOURCE_EXHAUSTED when the disk is full, DATA_LOSS on an input/output error.
  absl::Status Commit();

 private:
  AtomicFile() = default;
  void Flush();
  void Discard();

  std::string path_;       // as the caller named it, for messages
  std::string target_;     // `path_` with links resolved
  std::string temporary_;  // empty when writing directly, and after Commit()
  std::string buffer_;
  int fd_ = -1;
  absl::Status status_;
};

// Create, Append, Commit.
absl::Status WriteFileAtomically(const std::string& path, std::string_view bytes);

}  // namespace curvereg

#endif  // CURVEREG_FILES_ATOMIC_FILE_H_
