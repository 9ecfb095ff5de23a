// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/page_token.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kPlaceDigits = 16;

}  // namespace

std::string TokenOfPlace(int64_t place) {
  const std::string digits = absl::StrCat(absl::Hex(place, absl::kZeroPad16));
  return absl::StrCat(digits, absl::Hex(wire::Crc32c("page " + digits), absl::kZeroPad8));
}

std::optional<int64_t> PlaceOfToken(const std::string& token) {
  const std::string_view digits = std::string_view(token).substr(0, kPlaceDigits);
  int64_t place = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), place, 16);
  // What reads as a number and is written the same, checksum and all, is ours.
  if (error != std::errc() || place < 0 || TokenOfPlace(place) != token) return std::nullopt;
  return place;
}

absl::StatusOr<int64_t> PlaceOf(const std::string& page_token, int64_t first) {
  if (page_token.empty()) return first;
  const std::optional<int64_t> place = PlaceOfToken(page_token);
  if (!place.has_value()) return wire::FieldError("page_token", "not one of this server's");
  return *place;
}

absl::StatusOr<int> PageSize(int wanted, int standard) {
  if (wanted < 0) return wire::FieldError("page_size", "must not be below 0");
  return wanted == 0 ? standard : std::min(wanted, kMaxPageSize);
}

}  // namespace curvereg::server
