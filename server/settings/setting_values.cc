// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/setting_values.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace curvereg::server {
namespace {

struct Unit {
  std::string_view name;
  uint64_t bytes;
};
// Binary units in rising order; values are printed with the largest that divides them.
constexpr std::array<Unit, 4> kBinaryUnits = {
    {{"KiB", uint64_t{1} << 10}, {"MiB", uint64_t{1} << 20}, {"GiB", uint64_t{1} << 30}, {"TiB", uint64_t{1} << 40}}};
constexpr std::array<Unit, 6> kOtherUnits = {
    {{"", 1}, {"B", 1}, {"kB", 1'000}, {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}}};

std::optional<uint64_t> UnitBytes(std::string_view name) {
  for (const Unit& unit : kBinaryUnits) {
    if (unit.name == name) return unit.bytes;
  }
  for (const Unit& unit : kOtherUnits) {
    if (unit.name == name) return unit.bytes;
  }
  return std::nullopt;
}

// Digits, a minus sign where T has one, then a unit where units are allowed.
template <typename T>
std::optional<T> ParseNumber(std::string_view text, bool with_unit) {
  T number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (!with_unit) return rest.empty() ? std::optional(number) : std::nullopt;
  if (rest.size() > 1 && rest.front() == ' ') rest.remove_prefix(1);  // "512 MiB"
  const std::optional<uint64_t> unit = UnitBytes(rest);
  if (!unit.has_value() || number < 0) return std::nullopt;
  if (static_cast<uint64_t>(number) > static_cast<uint64_t>(std::numeric_limits<T>::max()) / *unit) return std::nullopt;
  return static_cast<T>(static_cast<uint64_t>(number) * *unit);
}

template <typename T>
absl::Status SetNumber(const Setting& setting, std::string_view text, T& value) {
  const bool is_size = setting.kind == SettingKind::kBytes;
  const std::optional<T> number = ParseNumber<T>(text, is_size);
  if (!number.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(is_size ? "expected a size such as 512MiB" : "expected a whole number", " of at most ",
                     std::numeric_limits<T>::max(), ", not \"", std::string(text), "\""));
  }
  value = *number;
  return absl::OkStatus();
}

// TOML's "\u0000" ends the names of files early.
absl::Status SetText(std::string_view text, std::string& value) {
  if (text.find('\0') != std::string_view::npos) return absl::InvalidArgumentError("must not contain a zero byte");
  value = text;
  return absl::OkStatus();
}

absl::Status SetSwitch(std::string_view text, bool& value) {
  if (text != "true" && text != "false") {
    return absl::InvalidArgumentError(absl::StrCat("expected true or false, not \"", std::string(text), "\""));
  }
  value = text == "true";
  return absl::OkStatus();
}

std::string TomlString(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      absl::StrAppendFormat(&quoted, "\\u%04X", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string TomlSize(uint64_t bytes) {
  for (auto unit = kBinaryUnits.rbegin(); unit != kBinaryUnits.rend(); ++unit) {
    if (bytes != 0 && bytes % unit->bytes == 0) return absl::StrCat("\"", bytes / unit->bytes, unit->name.data(), "\"");
  }
  return absl::StrCat(bytes);
}

}  // namespace

absl::Status SetFromText(const Setting& setting, std::string_view text, ServerConfig& config) {
  return std::visit(
      [&](auto member) -> absl::Status {
        auto& value = *member(config);
        using T = std::remove_reference_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return SetText(text, value);
        } else if constexpr (std::is_same_v<T, bool>) {
          return SetSwitch(text, value);
        } else {
          return SetNumber(setting, text, value);
        }
      },
      setting.field);
}

std::string TomlValue(const Setting& setting, const ServerConfig& config) {
  ServerConfig copy = config;  // the table's functions give out members to write to
  return std::visit(
      [&](auto member) -> std::string {
        const auto& value = *member(copy);
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return TomlString(value);
        } else if constexpr (std::is_same_v<T, bool>) {
          return value ? "true" : "false";
        } else {
          return setting.kind == SettingKind::kBytes ? TomlSize(static_cast<uint64_t>(value)) : absl::StrCat(value);
        }
      },
      setting.field);
}

}  // namespace curvereg::server
