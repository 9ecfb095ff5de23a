// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/orphaned_files.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "server/store/store_file.h"

namespace curvereg::server {

absl::Status OrphanedFiles::Take(const std::string& path, const std::string& name) {
  if (absl::Status status = MakeFolder(folder_); !status.ok()) return status;
  std::string target = folder_ + "/" + name;
  std::error_code error;
  for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(target, error)); ++i) {
    target = absl::StrCat(folder_, "/", name, ".", i);
  }
  if (rename(path.c_str(), target.c_str()) != 0) return FileError(path, "cannot set aside", errno);
  ++num_taken_;
  return SyncFolder(folder_);
}

}  // namespace curvereg::server
