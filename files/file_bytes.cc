// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <optional>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{8} << 20;

// Closes the descriptor at the end of a scope.
struct Descriptor {
  explicit Descriptor(int number) : fd(number) {}
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int fd;
};

std::unique_ptr<char[]> AllocateBytes(std::size_t size) {
  return std::unique_ptr<char[]>(new (std::nothrow) char[size]);
}

absl::Status TooLarge(const std::string& path, uint64_t max_bytes) {
  return absl::ResourceExhaustedError(absl::StrCat(path, ": is larger than the limit of ", max_bytes, " bytes"));
}

absl::Status OutOfMemory(const std::string& path, uint64_t size) {
  return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory for its ", size, " bytes"));
}

// Bytes read into `to`, at most `size`; 0 at the end of the file; nullopt with errno set on failure.
std::optional<std::size_t> ReadSome(int fd, char* to, std::size_t size) {
  while (true) {
    const ssize_t num_read = read(fd, to, size);
    if (num_read >= 0) return static_cast<std::size_t>(num_read);
    if (errno != EINTR) return std::nullopt;
  }
}

}  // namespace

absl::Status WithPath(const std::string& path, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
}

absl::Status ErrnoStatus(const std::string& path, absl::string_view action, int error_number) {
  absl::StatusCode code = absl::ErrnoToStatusCode(error_number);
  if (error_number == EIO) code = absl::StatusCode::kDataLoss;
  if (error_number == EFBIG || error_number == EDQUOT) code = absl::StatusCode::kResourceExhausted;
  if (error_number == ENOTDIR) code = absl::StatusCode::kNotFound;
  if (error_number == EROFS) code = absl::StatusCode::kPermissionDenied;
  return absl::Status(
      code, absl::StrCat(path, ": ", action, ": ", std::error_code(error_number, std::generic_category()).message()));
}

absl::StatusOr<FileBytes> ReadFileBytes(const std::string& path, uint64_t max_bytes,
                                        const std::function<void(double)>& progress) {
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) return ErrnoStatus(path, "cannot open", errno);
  struct stat info {};
  if (fstat(file.fd, &info) != 0) return ErrnoStatus(path, "cannot read", errno);
  if (S_ISDIR(info.st_mode)) return absl::InvalidArgumentError(absl::StrCat(path, ": is a folder, not a file"));

  const uint64_t expected = S_ISREG(info.st_mode) ? static_cast<uint64_t>(info.st_size) : 0;
  if (expected > max_bytes) return TooLarge(path, max_bytes);
  // One byte more than expected, so that the end of the file is met without growing.
  std::size_t capacity = expected > 0 ? static_cast<std::size_t>(expected) + 1 : kChunkBytes;
  FileBytes result;
  result.bytes_ = AllocateBytes(capacity);
  if (result.bytes_ == nullptr) return OutOfMemory(path, capacity);
  while (true) {
    if (result.size_ == capacity) {
      // Pipes, and files that grow while they are read.
      std::unique_ptr<char[]> larger = AllocateBytes(2 * capacity);
      if (larger == nullptr) return OutOfMemory(path, 2 * capacity);
      std::copy_n(result.bytes_.get(), result.size_, larger.get());
      result.bytes_ = std::move(larger);
      capacity *= 2;
    }
    const std::optional<std::size_t> num_read =
        ReadSome(file.fd, result.bytes_.get() + result.size_, std::min(kChunkBytes, capacity - result.size_));
    if (!num_read.has_value()) return ErrnoStatus(path, "cannot read", errno);
    if (*num_read == 0) return result;
    result.size_ += *num_read;
    if (result.size_ > max_bytes) return TooLarge(path, max_bytes);
    if (progress && expected > 0) {
      progress(std::min(1.0, static_cast<double>(result.size_) / static_cast<double>(expected)));
    }
  }
}

}  // namespace curvereg
