// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/access/token_file.h"

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "server/settings/toml_text.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kDigestDigits = 64;

std::optional<std::string> DigestFromHex(const std::string& text) {
  const bool is_hex = text.size() == kDigestDigits &&
                      std::all_of(text.begin(), text.end(), [](unsigned char c) { return absl::ascii_isxdigit(c); });
  return is_hex ? std::optional(absl::HexStringToBytes(text)) : std::nullopt;
}

// Sets the member that the key names; what is wrong, or empty.
std::string SetMember(std::string_view key, const std::string& value, TokenEntry& entry) {
  if (key == "name") {
    entry.name = value;
    return IsTokenName(value) ? "" : "name must be 1 to 64 of a-z A-Z 0-9 - _ . @";
  }
  if (key == "scope") {
    const std::optional<Scope> scope = ScopeFromName(value);
    entry.scope = scope.value_or(Scope::kRead);
    return scope.has_value() ? "" : "scope must be read, write or admin";
  }
  if (key == "sha256") {
    const std::optional<std::string> digest = DigestFromHex(value);
    entry.sha256 = digest.value_or("");
    return digest.has_value() ? "" : "sha256 must be 64 hexadecimal digits";
  }
  return absl::StrCat("a token has name, scope and sha256, no \"", std::string(key), "\"");
}

absl::StatusOr<TokenEntry> ParseEntry(const toml::table& table, const std::string& file_name) {
  TokenEntry entry;
  for (const auto& [key, node] : table) {
    const auto* value = node.as_string();
    if (value == nullptr) {
      return TomlError(file_name, key.source(), absl::StrCat(std::string(key.str()), " must be a string"));
    }
    const std::string error = SetMember(key.str(), value->get(), entry);
    if (!error.empty()) return TomlError(file_name, key.source(), error);
  }
  for (const char* key : {"name", "scope", "sha256"}) {
    if (!table.contains(key)) return TomlError(file_name, table.source(), absl::StrCat("the token has no ", key));
  }
  return entry;
}

}  // namespace

absl::StatusOr<std::vector<TokenEntry>> ParseTokenFile(std::string_view text, const std::string& file_name) {
  const absl::StatusOr<toml::table> file = ParseToml(text, file_name);
  if (!file.ok()) return file.status();
  std::vector<TokenEntry> entries;
  for (const auto& [key, node] : *file) {
    if (key.str() != "token" || !node.is_array_of_tables()) {
      return TomlError(file_name, key.source(), "only [[token]] tables are expected");
    }
    for (const toml::node& table : *node.as_array()) {
      absl::StatusOr<TokenEntry> entry = ParseEntry(*table.as_table(), file_name);
      if (!entry.ok()) return entry.status();
      const bool is_known = std::any_of(entries.begin(), entries.end(),
                                        [&](const TokenEntry& other) { return other.sha256 == entry->sha256; });
      if (is_known) return TomlError(file_name, table.source(), "this token is in the file twice");
      entries.push_back(*std::move(entry));
    }
  }
  return entries;
}

}  // namespace curvereg::server
