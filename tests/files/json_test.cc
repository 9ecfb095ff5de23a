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
  EXPECT_EQ(Json().Text(), "null");
  EXPECT_EQ(Json(true).Text(), "true");
  EXPECT_EQ(Json(-3).Text(), "-3");
  EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).Text(), "18446744073709551615");
  EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).Text(), "-9223372036854775808");
  EXPECT_EQ(Json(0.1).Text(), "0.1");
  EXPECT_EQ(Json(2.0).Text(), "2.0");
  EXPECT_EQ(Json("a \"b\"\n").Text(), R"("a \"b\"\n")");
}

TEST(JsonTest, NumbersThatJsonDoesNotHaveAreNull) {
  EXPECT_EQ(Json(std::nan("")).Text(), "null");
  EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).Text(), "null");
}

TEST(JsonTest, MembersKeepTheirOrder) {
  const Json json = {{"z", 1}, {"a", {1.5, 2, "three"}}, {"inner", {{"k", nullptr}}}};
  EXPECT_EQ(json.Text(), R"({"z":1,"a":[1.5,2,"three"],"inner":{"k":null}})");
}

TEST(JsonTest, ListsThatAreNotPairsOfANameAndAValueAreArrays) {
  EXPECT_EQ(Json({1, 2, 3}).Text(), "[1,2,3]");
  EXPECT_EQ(Json({{"a", 1}, 2}).Text(), R"([["a",1],2])");
  EXPECT_EQ(Json({{1, 2}, {3, 4}}).Text(), "[[1,2],[3,4]]");
  EXPECT_EQ(Json::Array().Text(), "[]");
  EXPECT_EQ(Json::Array({Json({{"a", 1}})}).Text(), R"([{"a":1}])");
  EXPECT_EQ(Json::Object().Text(), "{}");
  EXPECT_EQ(Json(std::vector<int>{4, 5}).Text(), "[4,5]");
}

TEST(JsonTest, MembersAreSetAddedAndUpdated) {
  Json json;
  json["a"] = 1;
  json["b"]["c"] = "d";
  json["a"] = 2;
  json.Update({{"b", 3}, {"e", 4}});
  EXPECT_EQ(json.Text(), R"({"a":2,"b":3,"e":4})");
  Json list;
  list.Append({{"x", 1}});
  list.Append(7);
  EXPECT_EQ(list.Text(), R"([{"x":1},7])");
}

TEST(JsonTest, IndentsAndReplacesWhatIsNotUtf8) {
  EXPECT_EQ(Json({{"a", {1}}}).Text(2), "{\n  \"a\": [\n    1\n  ]\n}");
  EXPECT_EQ(Json(std::string("\xff")).Text(), "\"\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace curvereg
