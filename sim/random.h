// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Counter-based random numbers: each beam, rock and vertex owns a stream named by its key, so the bytes of a scan do
// not depend on the order in which threads come to it. No std::..._distribution: their output is the library's choice.
#ifndef CURVEREG_SIM_RANDOM_H_
#define CURVEREG_SIM_RANDOM_H_

#include <cmath>
#include <cstdint>
#include <numbers>

namespace curvereg::sim {

// The finaliser of SplitMix64: a bijection of 64-bit words whose output bits all depend on all input bits.
constexpr uint64_t MixBits(uint64_t word) {
  word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9ULL;
  word = (word ^ (word >> 27)) * 0x94d049bb133111ebULL;
  return word ^ (word >> 31);
}

// The key of stream `index` below `key`; keys of different (key, index) are unrelated.
constexpr uint64_t SubKey(uint64_t key, uint64_t index) {
  return MixBits(MixBits(key + 0x9e3779b97f4a7c15ULL) ^ (index * 0xd1342543de82ef95ULL + 0x2545f4914f6cdd1dULL));
}

// A stream of numbers that depends on its key alone.
class RandomStream {
 public:
  explicit RandomStream(uint64_t key) : state_(key) {}

  uint64_t Bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return MixBits(state_);
  }

  // Uniform in [0, 1), a multiple of 2^-53.
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  // Standard normal (Box-Muller; two draws of Bits() each).
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  uint64_t state_;
};

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_RANDOM_H_
