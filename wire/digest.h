// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Checks of bytes: CRC-32C of chunks, digests of payloads.
#ifndef CURVEREG_WIRE_DIGEST_H_
#define CURVEREG_WIRE_DIGEST_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::wire {

// CRC-32C (Castagnoli polynomial, reflected, initial and final complement; RFC 3720): "123456789" gives 0xE3069283.
uint32_t Crc32c(std::string_view bytes);
// Of bytes that have `crc` with more after them; `crc` of none is 0.
uint32_t ExtendCrc32c(uint32_t crc, std::string_view bytes);

// Computes a digest piece by piece. Movable, not shared between threads.
class Digester {
 public:
  // INVALID_FIELD "algorithm": not one that we know.
  static absl::StatusOr<Digester> Create(v1::DigestAlgorithm algorithm);
  Digester(Digester&&) noexcept;
  Digester& operator=(Digester&&) noexcept;
  ~Digester();

  void Update(std::string_view bytes);
  // Of all bytes so far; may be called at any time.
  v1::Digest Digest() const;

 private:
  struct State;
  explicit Digester(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Of all bytes at once. Precondition: `algorithm` is one that we know.
v1::Digest DigestOf(v1::DigestAlgorithm algorithm, std::string_view bytes);

// XXH3-64 of `num_bytes` bytes whose XXH3_128 is `digest`. That is its lower half by the construction of XXH3, but for
// short inputs, which have formulas of their own (xxHash's specification, "XXH3 Algorithm (for long inputs)"): none for
// at most 240 bytes.
std::optional<uint64_t> Xxh3Of64Bits(const v1::Digest& digest, uint64_t num_bytes);

bool SameDigest(const v1::Digest& a, const v1::Digest& b);

// INVALID_FIELD "algorithm" or "value": unknown, or not of its length.
absl::Status ValidateDigest(const v1::Digest& digest);

// Lower-case hexadecimal digits.
std::string HexText(std::string_view bytes);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_DIGEST_H_
