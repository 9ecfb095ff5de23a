// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The file of tokens: a TOML array of [[token]] tables with name, scope and sha256.
#ifndef CURVEREG_SERVER_ACCESS_TOKEN_FILE_H_
#define CURVEREG_SERVER_ACCESS_TOKEN_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "server/access/access.h"

namespace curvereg::server {

struct TokenEntry {
  std::string name;
  Scope scope = Scope::kRead;
  std::string sha256;  // 32 bytes
};

// INVALID_ARGUMENT "FILE:LINE: ...": not TOML, an unknown key, a key that is missing or malformed, a digest twice.
absl::StatusOr<std::vector<TokenEntry>> ParseTokenFile(std::string_view text, const std::string& file_name);

bool IsTokenName(std::string_view name);  // see MakeToken

// SHA-256, 32 bytes.
std::string TokenDigest(std::string_view token);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_ACCESS_TOKEN_FILE_H_
