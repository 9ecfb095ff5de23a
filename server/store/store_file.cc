// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/store_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {

absl::Status FileError(const std::string& path, std::string_view action, int error_number) {
  const bool is_full = error_number == ENOSPC || error_number == EDQUOT;
  return wire::MakeError(is_full ? v1::ERROR_REASON_STORAGE_FULL : v1::ERROR_REASON_STORAGE_FAULT,
                         absl::StrCat(std::filesystem::path(path).filename().string(), ": ", std::string(action), ": ",
                                      std::generic_category().message(error_number)));
}

absl::StatusOr<StoreFile> StoreFile::OpenToRead(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return FileError(path, "cannot open", errno);
  return StoreFile(path, fd);
}

absl::StatusOr<StoreFile> StoreFile::OpenToWrite(const std::string& path) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return FileError(path, "cannot create", errno);
  return StoreFile(path, fd);
}

StoreFile::StoreFile(StoreFile&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

StoreFile& StoreFile::operator=(StoreFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  return *this;
}

StoreFile::~StoreFile() {
  if (fd_ >= 0) close(fd_);
}

absl::StatusOr<bool> StoreFile::TryLock() {
  if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return true;
  if (errno == EWOULDBLOCK) return false;
  return FileError(path_, "cannot lock", errno);
}

absl::StatusOr<uint64_t> StoreFile::Size() const {
  struct stat info {};
  if (fstat(fd_, &info) != 0) return FileError(path_, "cannot look at", errno);
  return static_cast<uint64_t>(info.st_size);
}

absl::Status StoreFile::WriteAt(uint64_t offset, std::span<const std::string_view> pieces) {
  std::size_t done = 0;  // of the first piece
  while (true) {
    while (!pieces.empty() && done >= pieces.front().size()) {
      done -= pieces.front().size();
      pieces = pieces.subspan(1);
    }
    if (pieces.empty()) return absl::OkStatus();
    std::array<iovec, 256> vectors;
    const std::size_t num_vectors = std::min(pieces.size(), vectors.size());
    for (std::size_t i = 0; i < num_vectors; ++i) {
      // The kernel only reads.
      vectors[i] = {const_cast<char*>(pieces[i].data()), pieces[i].size()};
    }
    vectors[0] = {const_cast<char*>(pieces[0].data()) + done, pieces[0].size() - done};
    const ssize_t written = pwritev(fd_, vectors.data(), static_cast<int>(num_vectors), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return FileError(path_, "cannot write", errno);
    done += static_cast<std::size_t>(written);
    offset += static_cast<uint64_t>(written);
  }
}

absl::StatusOr<std::string> StoreFile::ReadAt(uint64_t offset, uint64_t size) const {
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = pread(fd_, bytes.data() + filled, bytes.size() - filled, static_cast<off_t>(offset + filled));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return FileError(path_, "cannot read", errno);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  bytes.resize(filled);
  return bytes;
}

absl::Status StoreFile::Truncate(uint64_t size) {
  if (ftruncate(fd_, static_cast<off_t>(size)) != 0) return FileError(path_, "cannot cut", errno);
  return absl::OkStatus();
}

absl::Status StoreFile::Allocate(uint64_t size) {
  const int error_number = posix_fallocate(fd_, 0, static_cast<off_t>(size));
  return error_number == 0 ? absl::OkStatus() : FileError(path_, "cannot take space", error_number);
}

void StoreFile::Preallocate(uint64_t offset, uint64_t size) {
  static_cast<void>(fallocate(fd_, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset), static_cast<off_t>(size)));
}

void StoreFile::StartWriteback(uint64_t offset, uint64_t size) {
  // Only advice: SyncData reports what goes wrong.
  static_cast<void>(sync_file_range(fd_, static_cast<off_t>(offset), static_cast<off_t>(size), SYNC_FILE_RANGE_WRITE));
}

absl::Status StoreFile::SyncData() {
  if (fdatasync(fd_) != 0) return FileError(path_, "cannot force to disk", errno);
  return absl::OkStatus();
}

absl::Status SyncFolder(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return FileError(path, "cannot open", errno);
  const int error_number = fsync(fd) == 0 ? 0 : errno;
  close(fd);
  // EINVAL: a file system that cannot do so for folders.
  if (error_number == 0 || error_number == EINVAL) return absl::OkStatus();
  return FileError(path, "cannot force to disk", error_number);
}

absl::Status MakeFolder(const std::string& path) {
  if (mkdir(path.c_str(), 0700) == 0 || errno == EEXIST) return absl::OkStatus();
  return FileError(path, "cannot create the folder", errno);
}

absl::StatusOr<std::vector<std::string>> ListFolder(const std::string& path) {
  std::error_code error;
  std::vector<std::string> names;
  std::filesystem::directory_iterator entry(path, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    names.push_back(entry->path().filename().string());
    entry.increment(error);
  }
  if (error) return FileError(path, "cannot list", error.value());
  return names;
}

std::optional<FileInfo> LookAt(const std::string& path) {
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FileInfo{{info.st_dev, info.st_ino}, static_cast<uint64_t>(info.st_size), uint64_t{info.st_nlink}};
}

absl::Status RemoveFile(const std::string& path) {
  if (unlink(path.c_str()) == 0 || errno == ENOENT) return absl::OkStatus();
  return FileError(path, "cannot remove", errno);
}

uint64_t FreeBytes(const std::string& path) {
  struct statvfs info {};
  if (statvfs(path.c_str(), &info) != 0 || info.f_blocks == 0) return std::numeric_limits<uint64_t>::max();
  return uint64_t{info.f_bavail} * info.f_frsize;
}

}  // namespace curvereg::server
