// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/pcd_file.h"
#include "fuzz/check_cloud.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const auto scan = curvereg::ParsePcd(curvereg::AsText(data, size), curvereg::FuzzOptions());
  // Compressed data may grow by up to 88, see lzf.h.
  curvereg::CheckCloud(scan.status(), scan.ok() ? &*scan : nullptr, 88 * size);
  return 0;
}
