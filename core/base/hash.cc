// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash.h"

#ifdef __x86_64__
#include <xxh_x86dispatch.h>  // the processor's widest instructions, found at run time
#else
#include <xxhash.h>
#endif

#include "core/base/simd.h"

namespace curvereg {

uint64_t HashOf(std::string_view bytes, uint64_t seed) {
  const uint64_t hash = XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
  ClearUpperVectorHalves();
  return hash;
}

}  // namespace curvereg
