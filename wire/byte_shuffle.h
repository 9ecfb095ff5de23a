// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// First bytes of all points, then second bytes of all points, ...: bytes of like meaning side by side, which a
// compressor wants. With n points of `stride` bytes, planes[j * n + i] = points[i * stride + j].
#ifndef CURVEREG_WIRE_BYTE_SHUFFLE_H_
#define CURVEREG_WIRE_BYTE_SHUFFLE_H_

#include <cstddef>
#include <string_view>

namespace curvereg::wire {

// Preconditions: stride above 0 divides the number of bytes; `planes` and `points` have room for as many bytes.
void ShuffleBytes(std::string_view points, size_t stride, char* planes);
void UnshuffleBytes(std::string_view planes, size_t stride, char* points);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_BYTE_SHUFFLE_H_
