// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/small_file.h"

#include <cstdint>

#include "files/file_bytes.h"

namespace curvereg::server {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 20;

}  // namespace

absl::StatusOr<std::string> ReadSmallFile(const std::string& path) {
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(path, kMaxFileBytes);
  if (!bytes.ok()) return bytes.status();
  return std::string(bytes->view());
}

}  // namespace curvereg::server
