// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/kitti_file.h"
#include "fuzz/check_cloud.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const auto scan = curvereg::ParseKitti(curvereg::AsText(data, size), curvereg::FuzzOptions());
  curvereg::CheckCloud(scan.status(), scan.ok() ? &*scan : nullptr, size);
  return 0;
}
