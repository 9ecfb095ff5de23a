// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace curvereg {
namespace {

using nlohmann::ordered_json;

bool IsMember(const Json& element) {
  const auto* pair = std::get_if<Json::Elements>(&element.value());
  return pair != nullptr && pair->size() == 2 && std::holds_alternative<std::string>((*pair)[0].value());
}

ordered_json ToLibrary(const Json& json);

struct Converter {
  ordered_json operator()(const Json::Elements& elements) const {
    ordered_json array = ordered_json::array();
    for (const Json& element : elements) array.push_back(ToLibrary(element));
    return array;
  }
  ordered_json operator()(const Json::Members& members) const {
    ordered_json object = ordered_json::object();
    for (const auto& [name, member] : members) object[name] = ToLibrary(member);
    return object;
  }
  template <typename Scalar>
  ordered_json operator()(const Scalar& scalar) const {
    return scalar;
  }
};

ordered_json ToLibrary(const Json& json) { return std::visit(Converter(), json.value()); }

}  // namespace

Json::Json(std::initializer_list<Json> elements) {
  if (!std::all_of(elements.begin(), elements.end(), IsMember)) {
    value_ = Elements(elements);
    return;
  }
  *this = Object();
  for (const Json& element : elements) {
    const Elements& pair = std::get<Elements>(element.value_);
    (*this)[std::get<std::string>(pair[0].value_)] = pair[1];
  }
}

Json Json::Array(Elements elements) {
  Json json;
  json.value_ = std::move(elements);
  return json;
}

Json Json::Object() {
  Json json;
  json.value_ = Members();
  return json;
}

Json& Json::operator[](std::string_view name) {
  if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Members();
  Members& members = std::get<Members>(value_);
  const auto found = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.first == name; });
  if (found != members.end()) return found->second;
  return members.emplace_back(std::string(name), Json()).second;
}

void Json::Append(Json element) {
  if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Elements();
  std::get<Elements>(value_).push_back(std::move(element));
}

void Json::Update(const Json& object) {
  for (const auto& [name, member] : std::get<Members>(object.value_)) (*this)[name] = member;
}

std::string JsonText(const Json& json, int indent) {
  return ToLibrary(json).dump(indent, ' ', /*ensure_ascii=*/false, ordered_json::error_handler_t::replace);
}

}  // namespace curvereg
