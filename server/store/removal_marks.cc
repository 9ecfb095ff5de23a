// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/removal_marks.h"

#include <unistd.h>

#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "absl/status/statusor.h"
#include "server/store/store_file.h"

namespace curvereg::server {

void RemovalMarks::Set(const std::string& path, const std::string& name) const {
  Clear(name);
  if (!MakeFolder(folder_).ok()) return;
  // Without it the file is set aside if we are interrupted.
  static_cast<void>(link(path.c_str(), (folder_ + "/" + name).c_str()));
}

void RemovalMarks::Clear(const std::string& name) const { static_cast<void>(RemoveFile(folder_ + "/" + name)); }

bool RemovalMarks::IsSet(const std::string& path, const std::string& name) const {
  const std::optional<FileInfo> file = LookAt(path);
  const std::optional<FileInfo> mark = LookAt(folder_ + "/" + name);
  return file.has_value() && mark.has_value() && file->identity == mark->identity;
}

absl::Status RemovalMarks::ClearAll() const {
  std::error_code error;
  if (!std::filesystem::exists(folder_, error)) return absl::OkStatus();
  const absl::StatusOr<std::vector<std::string>> names = ListFolder(folder_);
  if (!names.ok()) return names.status();
  for (const std::string& name : *names) {
    if (absl::Status status = RemoveFile(folder_ + "/" + name); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace curvereg::server
