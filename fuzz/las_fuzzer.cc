// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/las_file.h"
#include "fuzz/check_cloud.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const auto cloud = curvereg::ParseLas(curvereg::AsText(data, size), curvereg::FuzzOptions());
  curvereg::CheckCloud(cloud.status(), cloud.ok() ? &cloud->scan : nullptr, size);
  return 0;
}
