// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Who may do what: bearer tokens with scopes, from a file that is read again when it changes.
#ifndef CURVEREG_SERVER_ACCESS_H_
#define CURVEREG_SERVER_ACCESS_H_

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace curvereg::server {

enum class Scope { kRead, kWrite, kAdmin };  // each holds the ones before it

class Access {
 public:
  // Everyone may do everything.
  static std::unique_ptr<Access> Open();
  // A TOML file of [[token]] tables: name, scopes (or scope), sha256 (hexadecimal digest of the token; tokens
  // themselves are not in the file). INVALID_ARGUMENT naming file and line. A changed file that cannot be read leaves
  // the old one in force and is logged.
  static absl::StatusOr<std::unique_ptr<Access>> FromFile(const std::string& path, int reload_seconds);
  virtual ~Access() = default;

  // `authorization`: value of the header, "Bearer TOKEN"; may be empty. Returns the token's name, empty when open.
  // UNAUTHENTICATED, SCOPE_MISSING. Compares in constant time.
  virtual absl::StatusOr<std::string> Check(std::string_view authorization, Scope needed) const = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_ACCESS_H_
