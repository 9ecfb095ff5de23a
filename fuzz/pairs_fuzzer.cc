// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Both text files of a data set: the same bytes as pairs.txt and as poses.txt.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "eval/dataset_text.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto pairs = curvereg::ParsePairs(text); pairs.ok()) {
    for (const curvereg::PairLine& line : *pairs) {
      const double overlap = line.pair.overlap;
      if (!curvereg::IsRigid(line.pair.T_target_source, 1e-9)) std::abort();
      if (overlap != -1.0 && !(overlap >= 0.0 && overlap <= 1.0)) std::abort();
    }
  }
  const auto poses = curvereg::ParseNamedPoses(text);
  if (!poses.ok()) return 0;
  for (const curvereg::PoseLine& line : *poses) {
    if (line.name.empty() || !curvereg::IsRigid(line.T_world_scan, 1e-9)) std::abort();
  }
  if (!poses->empty() && !curvereg::HasNamedPoses(text)) std::abort();
  return 0;
}
