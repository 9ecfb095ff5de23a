// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Who may do what: bearer tokens with scopes, from a file that is read again when it changes.
#ifndef CURVEREG_SERVER_ACCESS_ACCESS_H_
#define CURVEREG_SERVER_ACCESS_ACCESS_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "server/operations/logging.h"

namespace curvereg::server {

enum class Scope { kRead, kWrite, kAdmin };  // each holds the ones before it

class Access {
 public:
  // Everyone may do everything.
  static std::unique_ptr<Access> Open();
  // A TOML file of [[token]] tables: name, scope ("read", "write" or "admin"), sha256 (hexadecimal digest of the token;
  // tokens themselves are not in the file). INVALID_ARGUMENT naming the setting, the file and, where it was read, the
  // line. Read again when it changed, looked at every `reload_seconds`; one that cannot be read leaves the old one in
  // force. Both are logged to `logger`, which outlives the answer.
  static absl::StatusOr<std::unique_ptr<Access>> FromFile(const std::string& path, int reload_seconds, Logger& logger);
  virtual ~Access() = default;

  // `authorization`: value of the header, "Bearer TOKEN"; may be empty. Returns the token's name, empty when open.
  // UNAUTHENTICATED, SCOPE_MISSING. Compares in constant time.
  virtual absl::StatusOr<std::string> Check(std::string_view authorization, Scope needed) const = 0;
};

// "read", "write", "admin".
std::string_view ScopeName(Scope scope);
std::optional<Scope> ScopeFromName(std::string_view name);

// A new random token (256 bits) and the table that makes a token file accept it.
struct NewToken {
  std::string token;  // shown once, never stored
  std::string toml;   // "[[token]]\nname = ..."
};
// INVALID_ARGUMENT: a name that is empty, longer than 64 bytes or not of letters, digits, '-', '_', '.' and '@'.
absl::StatusOr<NewToken> MakeToken(std::string_view name, Scope scope);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_ACCESS_ACCESS_H_
