// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "files/trajectory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const auto poses = curvereg::ParseTrajectory(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!poses.ok()) {
    if (!absl::IsInvalidArgument(poses.status()) || poses.status().message().empty()) std::abort();
    return 0;
  }
  for (const curvereg::StampedPose& pose : *poses) {
    if (!curvereg::IsRigid(pose.T_world_scan, 1e-9)) std::abort();
  }
  return 0;
}
