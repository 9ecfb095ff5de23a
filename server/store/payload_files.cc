// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/payload_files.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <utility>

#include "absl/strings/escaping.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kDigestBytes = 16;
constexpr uint64_t kReadBytes = uint64_t{1} << 20;

bool IsHex(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

// Some file systems know no second names; there a rename has to do, and whoever is stopped before the scan is recorded
// has to send it again.
int LinkOrRename(const std::string& source, const std::string& target) {
  if (link(source.c_str(), target.c_str()) == 0) return 0;
  if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS) return errno;
  return rename(source.c_str(), target.c_str()) == 0 ? 0 : errno;
}

}  // namespace

std::string PayloadFiles::FolderOf(const std::string& digest) const {
  return folder_ + "/" + wire::HexText(digest.substr(0, 1));
}

std::string PayloadFiles::PathOf(const std::string& digest) const {
  return FolderOf(digest) + "/" + wire::HexText(digest);
}

absl::StatusOr<std::vector<std::string>> PayloadFiles::List() const {
  const absl::StatusOr<std::vector<std::string>> folders = ListFolder(folder_);
  if (!folders.ok()) return folders.status();
  std::vector<std::string> digests;
  for (const std::string& folder : *folders) {
    if (folder.size() != 2 || !IsHex(folder)) continue;
    const absl::StatusOr<std::vector<std::string>> names = ListFolder(folder_ + "/" + folder);
    if (!names.ok()) return names.status();
    for (const std::string& name : *names) {
      if (name.size() == 2 * kDigestBytes && IsHex(name) && name.starts_with(folder)) {
        digests.push_back(absl::HexStringToBytes(name));
      }
    }
  }
  return digests;
}

std::optional<FileInfo> PayloadFiles::LookAt(const std::string& digest) const { return server::LookAt(PathOf(digest)); }

bool PayloadFiles::HasSize(const std::string& digest, uint64_t bytes) const {
  const std::optional<FileInfo> info = LookAt(digest);
  return info.has_value() && info->bytes == bytes;
}

PayloadFiles::State PayloadFiles::Check(const std::string& digest, uint64_t bytes) const {
  if (access(PathOf(digest).c_str(), F_OK) != 0) return State::kAbsent;
  return HasSize(digest, bytes) && HasDigest(digest, bytes) ? State::kIntact : State::kDamaged;
}

bool PayloadFiles::HasDigest(const std::string& digest, uint64_t bytes) const {
  absl::StatusOr<wire::Digester> digester = wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128);
  const absl::StatusOr<StoreFile> file = StoreFile::OpenToRead(PathOf(digest));
  if (!digester.ok() || !file.ok()) return false;
  for (uint64_t offset = 0; offset < bytes; offset += kReadBytes) {
    const absl::StatusOr<std::string> piece = file->ReadAt(offset, std::min(kReadBytes, bytes - offset));
    if (!piece.ok()) return false;
    digester->Update(*piece);
  }
  return digester->Digest().value() == digest;
}

absl::Status PayloadFiles::Add(const std::string& digest, const std::string& source, bool replace) {
  const std::string path = PathOf(digest);
  if (replace) {
    if (absl::Status status = RemoveFile(path); !status.ok()) return status;
  }
  int error_number = LinkOrRename(source, path);
  if (error_number == ENOENT) {  // the first in its folder
    absl::Status status = MakeFolder(FolderOf(digest));
    if (status.ok()) status = SyncFolder(folder_);
    if (!status.ok()) return status;
    error_number = LinkOrRename(source, path);
  }
  if (error_number != 0 && error_number != EEXIST) return FileError(path, "cannot create", error_number);
  return SyncFolder(FolderOf(digest));
}

absl::Status PayloadFiles::Remove(const std::string& digest) { return RemoveFile(PathOf(digest)); }

absl::StatusOr<std::string> PayloadFiles::Read(const std::string& digest, uint64_t offset, uint64_t size) const {
  const absl::StatusOr<StoreFile> file = StoreFile::OpenToRead(PathOf(digest));
  if (!file.ok()) return file.status();
  return file->ReadAt(offset, size);
}

}  // namespace curvereg::server
