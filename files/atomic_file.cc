// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/file_bytes.h"

namespace curvereg {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr int kMaxNames = 1000;

std::string FolderOf(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

// A new file beside `target`; its descriptor, or -1 with errno set. The name is hidden and contains the process id.
int OpenTemporary(const std::string& target, std::string* name) {
  const std::string file = std::filesystem::path(target).filename().string();
  for (int i = 0; i < kMaxNames; ++i) {
    *name = absl::StrCat(FolderOf(target), "/.", file, ".", getpid(), ".", i, ".tmp");
    const int fd = open(name->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

// The rename is on disk only when its folder is. Some file systems cannot sync folders; that is no failure.
void SyncFolderOf(const std::string& path) {
  const int fd = open(FolderOf(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  static_cast<void>(fsync(fd));
  close(fd);
}

}  // namespace

absl::StatusOr<AtomicFile> AtomicFile::Create(const std::string& path) {
  AtomicFile file;
  file.path_ = path;
  file.target_ = path;
  struct stat info {};
  const bool exists = stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": cannot write: is a folder"));
  }
  if (exists && !S_ISREG(info.st_mode)) {
    file.fd_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file.fd_ < 0) return ErrnoStatus(path, "cannot write", errno);
    return file;
  }
  if (exists) {
    std::error_code error;
    const std::filesystem::path resolved = std::filesystem::canonical(path, error);
    if (!error) file.target_ = resolved.string();
    // A rename would replace a file that the user has protected from writing.
    if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) return ErrnoStatus(path, "cannot write", errno);
  }
  file.fd_ = OpenTemporary(file.target_, &file.temporary_);
  if (file.fd_ < 0) {
    const int error_number = errno;
    file.temporary_.clear();
    return ErrnoStatus(path, "cannot write", error_number);
  }
  if (exists) static_cast<void>(fchmod(file.fd_, info.st_mode & 07777));
  return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, std::string())),
      buffer_(std::move(other.buffer_)),
      fd_(std::exchange(other.fd_, -1)),
      status_(std::move(other.status_)) {}

AtomicFile::~AtomicFile() { Discard(); }

void AtomicFile::Discard() {
  if (fd_ >= 0) close(std::exchange(fd_, -1));
  if (!temporary_.empty()) unlink(std::exchange(temporary_, std::string()).c_str());
}

void AtomicFile::Append(std::string_view bytes) {
  // Through the buffer in slices: one write per megabyte, however small or large the pieces are.
  while (!bytes.empty() && status_.ok()) {
    const std::string_view slice = bytes.substr(0, kBufferBytes - buffer_.size());
    buffer_.append(slice);
    bytes.remove_prefix(slice.size());
    if (buffer_.size() == kBufferBytes) Flush();
  }
}

void AtomicFile::Flush() {
  std::string_view rest = buffer_;
  while (!rest.empty() && status_.ok()) {
    const ssize_t written = write(fd_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      status_ = ErrnoStatus(path_, "cannot write", errno);
    }
  }
  buffer_.clear();
}

absl::Status AtomicFile::Commit() {
  Flush();
  if (status_.ok() && !temporary_.empty() && fsync(fd_) != 0) status_ = ErrnoStatus(path_, "cannot write", errno);
  if (fd_ >= 0 && close(std::exchange(fd_, -1)) != 0 && status_.ok()) {
    status_ = ErrnoStatus(path_, "cannot write", errno);
  }
  if (status_.ok() && !temporary_.empty()) {
    if (rename(temporary_.c_str(), target_.c_str()) != 0) {
      status_ = ErrnoStatus(path_, "cannot write", errno);
    } else {
      temporary_.clear();
      SyncFolderOf(target_);
    }
  }
  Discard();
  return status_;
}

absl::Status WriteFileAtomically(const std::string& path, std::string_view bytes) {
  absl::StatusOr<AtomicFile> file = AtomicFile::Create(path);
  if (!file.ok()) return file.status();
  file->Append(bytes);
  return file->Commit();
}

}  // namespace curvereg
