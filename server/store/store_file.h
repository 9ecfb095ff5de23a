// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Files of the store. Errors name the file (without its folder) and are STORAGE_FULL when the disk or a quota is full,
// else STORAGE_FAULT.
#ifndef CURVEREG_SERVER_STORE_STORE_FILE_H_
#define CURVEREG_SERVER_STORE_STORE_FILE_H_

#include <sys/types.h>

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg::server {

// "name: action: No space left on device".
absl::Status FileError(const std::string& path, std::string_view action, int error_number);

// An open file, closed when destroyed. Movable.
class StoreFile {
 public:
  static absl::StatusOr<StoreFile> OpenToRead(const std::string& path);
  // Creates it if need be, readable by its owner alone.
  static absl::StatusOr<StoreFile> OpenToWrite(const std::string& path);
  StoreFile(StoreFile&& other) noexcept;
  StoreFile& operator=(StoreFile&& other) noexcept;
  ~StoreFile();

  // Locks it until it is closed, at the latest by the death of the process; false: somebody else has it.
  absl::StatusOr<bool> TryLock();
  absl::StatusOr<uint64_t> Size() const;
  // The pieces one after the other.
  absl::Status WriteAt(uint64_t offset, std::span<const std::string_view> pieces);
  absl::Status WriteAt(uint64_t offset, std::string_view bytes) { return WriteAt(offset, {&bytes, 1}); }
  // Fewer than `size` at the end of the file.
  absl::StatusOr<std::string> ReadAt(uint64_t offset, uint64_t size) const;
  absl::Status Truncate(uint64_t size);
  // Makes it this long and takes the space on disk for it.
  absl::Status Allocate(uint64_t size);
  // Takes space on disk for bytes that are to come, at once rather than page by page, and leaves the length as it is.
  // Only to be quicker: what does not fit, or a file system that cannot do so, shows when the bytes are written.
  void Preallocate(uint64_t offset, uint64_t size);
  // Asks the kernel to begin writing these bytes to disk, so that SyncData has less to wait for.
  void StartWriteback(uint64_t offset, uint64_t size);
  absl::Status SyncData();

 private:
  StoreFile(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}
  std::string path_;
  int fd_ = -1;
};

// Forces the names in a folder to disk.
absl::Status SyncFolder(const std::string& path);
// Creates a folder, for its owner alone, unless it is there.
absl::Status MakeFolder(const std::string& path);
// Names of what is in a folder, in no order.
absl::StatusOr<std::vector<std::string>> ListFolder(const std::string& path);
// What a regular file is known by, whatever its names.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  auto operator<=>(const FileIdentity&) const = default;
};
struct FileInfo {
  FileIdentity identity;
  uint64_t bytes = 0;
  uint64_t num_names = 0;  // hard links
};
// None: no regular file of this name.
std::optional<FileInfo> LookAt(const std::string& path);
// Removes a file; none there is no error.
absl::Status RemoveFile(const std::string& path);
// Bytes that may still be written to the file system of a folder; no limit when it does not tell.
uint64_t FreeBytes(const std::string& path);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_STORE_FILE_H_
