// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pages of lists: their sizes, and their tokens, which are a place in the order of storing with a checksum that tells
// ours from others.
#ifndef CURVEREG_SERVER_STORE_PAGE_TOKEN_H_
#define CURVEREG_SERVER_STORE_PAGE_TOKEN_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"

namespace curvereg::server {

// Letters and digits. Precondition: place >= 0.
std::string TokenOfPlace(int64_t place);
std::optional<int64_t> PlaceOfToken(const std::string& token);

// As a request has it; `first` for an empty one. INVALID_FIELD "page_token": not one of ours.
absl::StatusOr<int64_t> PlaceOf(const std::string& page_token, int64_t first);

inline constexpr int kMaxPageSize = 1000;
// Entries of a page: 0 stands for `standard`; more than kMaxPageSize is cut to that. INVALID_FIELD "page_size": below
// 0.
absl::StatusOr<int> PageSize(int wanted, int standard = 100);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_PAGE_TOKEN_H_
