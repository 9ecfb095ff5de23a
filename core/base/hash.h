// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The hash behind the digests of results. Wherever bytes are stored or sent, wire/digest.h.
#ifndef CURVEREG_CORE_BASE_HASH_H_
#define CURVEREG_CORE_BASE_HASH_H_

#include <cstdint>
#include <string_view>

namespace curvereg {

// XXH3 with 64 bits (xxHash's specification).
uint64_t HashOf(std::string_view bytes, uint64_t seed = 0);

}  // namespace curvereg

#endif  // CURVEREG_CORE_BASE_HASH_H_
