// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/json.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace curvereg {
namespace {

TEST(JsonTest, WritesScalars) {
  EXPECT_EQ(JsonText(Json()), "null");
  EXPECT_EQ(JsonText(Json(true)), "true");
  EXPECT_EQ(JsonText(Json(-3)), "-3");
  EXPECT_EQ(JsonText(Json(std::numeric_limits<std::uint64_t>::max())), "18446744073709551615");
  EXPECT_EQ(JsonText(Json(std::numeric_limits<std::int64_t>::min())), "-9223372036854775808");
  EXPECT_EQ(JsonText(Json(0.1)), "0.1");
  EXPECT_EQ(JsonText(Json(2.0)), "2.0");
  EXPECT_EQ(JsonText(Json("a \"b\"\n")), R"("a \"b\"\n")");
}

TEST(JsonTest, NumbersThatJsonDoesNotHaveAreNull) {
  EXPECT_EQ(JsonText(Json(std::nan(""))), "null");
  EXPECT_EQ(JsonText(Json(std::numeric_limits<double>::infinity())), "null");
}

TEST(JsonTest, MembersKeepTheirOrder) {
  const Json json = {{"z", 1}, {"a", {1.5, 2, "three"}}, {"inner", {{"k", nullptr}}}};
  EXPECT_EQ(JsonText(json), R"({"z":1,"a":[1.5,2,"three"],"inner":{"k":null}})");
}

TEST(JsonTest, ListsThatAreNotPairsOfANameAndAValueAreArrays) {
  EXPECT_EQ(JsonText(Json({1, 2, 3})), "[1,2,3]");
  EXPECT_EQ(JsonText(Json({{"a", 1}, 2})), R"([["a",1],2])");
  EXPECT_EQ(JsonText(Json({{1, 2}, {3, 4}})), "[[1,2],[3,4]]");
  EXPECT_EQ(JsonText(Json::Array()), "[]");
  EXPECT_EQ(JsonText(Json::Array({Json({{"a", 1}})})), R"([{"a":1}])");
  EXPECT_EQ(JsonText(Json::Object()), "{}");
  EXPECT_EQ(JsonText(Json(std::vector<int>{4, 5})), "[4,5]");
}

TEST(JsonTest, MembersAreSetAddedAndUpdated) {
  Json json;
  json["a"] = 1;
  json["b"]["c"] = "d";
  json["a"] = 2;
  json.Update({{"b", 3}, {"e", 4}});
  EXPECT_EQ(JsonText(json), R"({"a":2,"b":3,"e":4})");
  Json list;
  list.Append({{"x", 1}});
  list.Append(7);
  EXPECT_EQ(JsonText(list), R"([{"x":1},7])");
}

TEST(JsonTest, IndentsAndReplacesWhatIsNotUtf8) {
  EXPECT_EQ(JsonText(Json({{"a", {1}}}), 2), "{\n  \"a\": [\n    1\n  ]\n}");
  EXPECT_EQ(JsonText(Json(std::string("\xff"))), "\"\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace curvereg
