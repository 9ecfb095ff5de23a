// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/heap_tuning.h"

#include <cstdlib>  // defines __GLIBC__ where the C library is that

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace curvereg {

void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kMappedFromBytes = 32 << 20;  // glibc takes no more
  constexpr int kTrimmedFromBytes = 128 << 20;
  mallopt(M_MMAP_THRESHOLD, kMappedFromBytes);
  mallopt(M_TRIM_THRESHOLD, kTrimmedFromBytes);
#endif
}

}  // namespace curvereg
