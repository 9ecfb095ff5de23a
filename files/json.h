// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// JSON to be written: values that keep the order of their members. nlohmann::json writes the text; its templates are
// compiled in one place instead of in every source that has something to report, which costs seconds in each.
#ifndef CURVEREG_FILES_JSON_H_
#define CURVEREG_FILES_JSON_H_

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace curvereg {

class Json {
 public:
  using Elements = std::vector<Json>;
  using Members = std::vector<std::pair<std::string, Json>>;
  using Value = std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Elements, Members>;

  // Implicit, so that `{{"name", name}, {"points", 12}, {"origin", {0.0, 0.0, 0.0}}}` is a value.
  Json(std::nullptr_t value = nullptr) : value_(value) {}
  Json(bool value) : value_(value) {}
  Json(double value) : value_(value) {}  // null where it is not finite
  Json(std::string value) : value_(std::move(value)) {}
  Json(std::string_view value) : value_(std::string(value)) {}
  Json(const char* value) : value_(std::string(value)) {}
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) Json(Integer value) {
    if constexpr (std::unsigned_integral<Integer>) {
      value_ = std::uint64_t{value};
    } else {
      value_ = std::int64_t{value};
    }
  }
  template <typename Element>
  Json(const std::vector<Element>& elements) : value_(Elements(elements.begin(), elements.end())) {}
  // An object when every element is a pair of a string and a value, else an array; as nlohmann::json decides.
  Json(std::initializer_list<Json> elements);

  static Json Array(Elements elements = {});
  static Json Object();

  // The member of this name, null when it is new. Null becomes an object; precondition: null or an object.
  Json& operator[](std::string_view name);
  // Null becomes an array; precondition: null or an array.
  void Append(Json element);
  // Sets the members that `object` has. Preconditions: both are objects.
  void Update(const Json& object);

  const Value& value() const { return value_; }

 private:
  Value value_;
};

// On one line, or indented by that many spaces. Bytes that are not UTF-8 become U+FFFD.
std::string JsonText(const Json& json, int indent = -1);

}  // namespace curvereg

#endif  // CURVEREG_FILES_JSON_H_
