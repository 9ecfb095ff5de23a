// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Decompression of LZF, the byte-oriented Lempel-Ziv variant of binary_compressed PCD files.
#ifndef CURVEREG_FILES_LZF_H_
#define CURVEREG_FILES_LZF_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace curvereg {

// Two bytes of control make at most 8 bytes, three at most 264: a stream cannot grow by more than this factor.
inline constexpr std::size_t kLzfMaxGrowth = 88;

// The `size` bytes that `compressed` stands for. A control byte c < 32 is followed by c + 1 literal bytes; else it
// starts a copy from behind: length (c >> 5) + 2, where c >> 5 == 7 adds one more byte to the length, and distance
// ((c & 31) << 8) + next byte + 1; the copy may overlap its own output.
// DATA_LOSS when the stream ends early, reaches before its start, or does not give exactly `size` bytes.
absl::StatusOr<std::string> LzfDecompress(std::string_view compressed, std::size_t size);

}  // namespace curvereg

#endif  // CURVEREG_FILES_LZF_H_
