// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// CURVEREG_DISPATCH before a function compiles it for several instruction sets and picks at run time the best that the
// processor has. Not under sanitizers, whose run time is not up when the choice is made.
// Products and sums are not fused (-ffp-contract=off), so every choice gives the same bytes.
#ifndef CURVEREG_CORE_BASE_SIMD_H_
#define CURVEREG_CORE_BASE_SIMD_H_

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(CURVEREG_SANITIZED)
#define CURVEREG_DISPATCH __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CURVEREG_DISPATCH
#endif

namespace curvereg {

// To be called after functions of other libraries that may leave the upper halves of the vector registers in use, as
// XXH3 and ISA-L's CRC-32C do: on such a thread plain SSE code is slower until somebody clears them. Not inlined, for
// no caller may have anything in them.
[[gnu::noinline]] inline void ClearUpperVectorHalves() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx")) __asm__ volatile("vzeroupper");
#endif
}

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_SIMD_H_
