// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/lzf.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

absl::Status Corrupt(absl::string_view cause, std::size_t position) {
  return absl::DataLossError(absl::StrCat("corrupt LZF data: ", cause, " at compressed byte ", position));
}

}  // namespace

absl::StatusOr<std::string> LzfDecompress(std::string_view compressed, std::size_t size) {
  if (size / kLzfMaxGrowth > compressed.size()) {
    return Corrupt(absl::StrCat(size, " bytes cannot come from ", compressed.size()), 0);
  }
  std::string output;
  output.reserve(size);
  std::size_t in = 0;
  while (in < compressed.size()) {
    const std::size_t control = static_cast<unsigned char>(compressed[in++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (compressed.size() - in < length) return Corrupt("literal bytes missing", in);
      if (size - output.size() < length) return Corrupt("more data than declared", in);
      output.append(compressed, in, length);
      in += length;
      continue;
    }
    const bool has_length_byte = (control >> 5) == 7;
    if (compressed.size() - in < (has_length_byte ? 2U : 1U)) return Corrupt("back reference cut off", in);
    std::size_t length = (control >> 5) + 2;
    if (has_length_byte) length += static_cast<unsigned char>(compressed[in++]);
    const std::size_t distance = ((control & 31) << 8) + static_cast<unsigned char>(compressed[in++]) + 1;
    if (distance > output.size()) return Corrupt("reference to before the start", in);
    if (size - output.size() < length) return Corrupt("more data than declared", in);
    // Byte by byte: the source may overlap what is being appended.
    for (std::size_t i = 0; i < length; ++i) output.push_back(output[output.size() - distance]);
  }
  if (output.size() != size) {
    return Corrupt(absl::StrCat("gives ", output.size(), " of ", size, " bytes, ends"), in);
  }
  return output;
}

}  // namespace curvereg
