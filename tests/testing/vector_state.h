// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_TESTING_VECTOR_STATE_H_
#define CURVEREG_TESTS_TESTING_VECTOR_STATE_H_

#include <cstdint>
#include <optional>

#ifdef __x86_64__
#include <cpuid.h>
#endif

namespace curvereg::testing {

// Whether the upper halves of the vector registers are in use on this thread, as the processor tells (XINUSE; Intel's
// manual, volume 1, chapter 13.6). None: it cannot, and the test is skipped.
inline std::optional<bool> UpperVectorHalvesInUse() {
#ifdef __x86_64__
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  constexpr unsigned kTellsUse = 1U << 2;
  if (!__builtin_cpu_supports("avx") || __get_cpuid_count(0xD, 1, &eax, &ebx, &ecx, &edx) == 0) return std::nullopt;
  if ((eax & kTellsUse) == 0) return std::nullopt;
  constexpr uint32_t kUpperHalves = 1U << 2 | 1U << 6;  // of YMM and of ZMM registers
  uint32_t low = 0, high = 0;
  __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(1));
  return (low & kUpperHalves) != 0;
#else
  return std::nullopt;
#endif
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_VECTOR_STATE_H_
