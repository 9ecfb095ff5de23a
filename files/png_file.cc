// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_file.h"

#include "absl/strings/str_cat.h"
#include "files/atomic_file.h"

namespace curvereg {

absl::Status WritePngFile(const std::string& path, const Image<Rgb>& picture) {
  const absl::StatusOr<std::string> bytes = EncodePng(picture);
  if (!bytes.ok()) return absl::Status(bytes.status().code(), absl::StrCat(path, ": ", bytes.status().message()));
  return WriteFileAtomically(path, *bytes);
}

}  // namespace curvereg
