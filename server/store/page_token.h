// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Page tokens of lists: a place in the order of storing, with a checksum that tells ours from others.
#ifndef CURVEREG_SERVER_STORE_PAGE_TOKEN_H_
#define CURVEREG_SERVER_STORE_PAGE_TOKEN_H_

#include <cstdint>
#include <optional>
#include <string>

namespace curvereg::server {

// Letters and digits. Precondition: place >= 0.
std::string TokenOfPlace(int64_t place);
std::optional<int64_t> PlaceOfToken(const std::string& token);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_PAGE_TOKEN_H_
