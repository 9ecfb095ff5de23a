// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/resource_names.h"

#include <algorithm>

#include "wire/error.h"

namespace curvereg::wire {
namespace {

constexpr std::size_t kScanIdDigits = 32;
constexpr std::size_t kMaxClientChosenIdLength = 64;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsHexDigit(char c) { return IsDigit(c) || (c >= 'a' && c <= 'f'); }
bool IsClientChosenIdCharacter(char c) { return IsDigit(c) || (c >= 'a' && c <= 'z') || c == '-'; }

std::string Compose(std::string_view prefix, std::string_view id) { return std::string(prefix).append(id); }

absl::StatusOr<std::string> ClientChosenIdOf(std::string_view name, std::string_view prefix, std::string_view field) {
  if (name.starts_with(prefix) && IsClientChosenId(name.substr(prefix.size()))) {
    return std::string(name.substr(prefix.size()));
  }
  return FieldError(field, "must be " + std::string(prefix) + " and 1 to 64 of a-z, 0-9 and '-'");
}

}  // namespace

std::string ScanName(std::string_view scan_id) { return Compose(kScanPrefix, scan_id); }

std::string UploadName(std::string_view upload_id) { return Compose(kUploadPrefix, upload_id); }

std::string TraverseName(std::string_view traverse_id) { return Compose(kTraversePrefix, traverse_id); }

absl::StatusOr<std::string> ScanIdOf(std::string_view name, std::string_view field) {
  if (IsScanName(name)) return std::string(name.substr(kScanPrefix.size()));
  return FieldError(field, "must be scans/ and 32 lower-case hexadecimal digits");
}

absl::StatusOr<std::string> UploadIdOf(std::string_view name, std::string_view field) {
  return ClientChosenIdOf(name, kUploadPrefix, field);
}

absl::StatusOr<std::string> TraverseIdOf(std::string_view name, std::string_view field) {
  return ClientChosenIdOf(name, kTraversePrefix, field);
}

bool IsScanName(std::string_view text) {
  if (!text.starts_with(kScanPrefix)) return false;
  text.remove_prefix(kScanPrefix.size());
  return text.size() == kScanIdDigits && std::all_of(text.begin(), text.end(), IsHexDigit);
}

bool IsClientChosenId(std::string_view text) {
  return !text.empty() && text.size() <= kMaxClientChosenIdLength &&
         std::all_of(text.begin(), text.end(), IsClientChosenIdCharacter);
}

}  // namespace curvereg::wire
