// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cloud_file.h"

#include "client/atomic_file.h"
#include "client/file_bytes.h"
#include "client/pcd_file.h"

namespace curvereg {

absl::StatusOr<Scan> ReadCloudFile(const std::string& path, const CloudReadOptions& options) {
  const absl::StatusOr<FileBytes> bytes = ReadFileBytes(path, uint64_t{1} << 34, options.progress);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<Scan> scan = ParsePcd(bytes->view(), options);
  if (!scan.ok()) return WithPath(path, scan.status());
  return scan;
}

absl::Status WriteCloudFile(const std::string& path, const Scan& scan, CloudEncoding encoding) {
  absl::StatusOr<AtomicFile> file = AtomicFile::Create(path);
  if (!file.ok()) return file.status();
  AppendPcd(scan, encoding, *file);
  return file->Commit();
}

bool HasCloudEnding(const std::string& path) { return path.ends_with(".pcd"); }

}  // namespace curvereg
