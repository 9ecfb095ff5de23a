// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/result_json.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace curvereg {
namespace {

TEST(ResultJson, AResultThatWasNotRunClaimsNothing) {
  const auto json = nlohmann::json::parse(JsonText(ResultJson(RegistrationResult{})));
  EXPECT_EQ(json["accepted"], false);
  EXPECT_EQ(json["reasons"], nlohmann::json::array({"not_run"}));
  EXPECT_TRUE(json["T_target_source"].is_null());
  EXPECT_TRUE(json["covariance"].is_null());
  EXPECT_TRUE(json["evidence"]["free_space_agreement"].is_null());
  EXPECT_EQ(json["evidence"]["num_matches"], 0);
}

TEST(ResultJson, NumbersComeBackToTheLastBit) {
  RegistrationResult result;
  result.T_target_source =
      TransformFromVector((Vector6d() << 0.1, 1.0 / 3.0, -0.7, 1e-17, 12345.678901234567, M_PI).finished());
  result.seed = std::numeric_limits<uint64_t>::max();
  const auto json = nlohmann::json::parse(JsonText(ResultJson(result)));
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) {
      EXPECT_EQ(json["T_target_source"][static_cast<std::size_t>(row)][static_cast<std::size_t>(col)].get<double>(),
                result.T_target_source->matrix()(row, col));
    }
  }
  EXPECT_EQ(json["seed"].get<uint64_t>(), result.seed);
}

TEST(ResultJson, WhatIsNotFiniteIsNull) {
  RegistrationResult result;
  result.degenerate_directions.push_back({.direction = Vector6d::Unit(3), .sigma = INFINITY});
  result.total_seconds = std::nan("");
  const auto json = nlohmann::json::parse(JsonText(ResultJson(result)));
  EXPECT_TRUE(json["degenerate_directions"][0]["sigma"].is_null());
  EXPECT_EQ(json["degenerate_directions"][0]["translation"], nlohmann::json::array({1.0, 0.0, 0.0}));
  EXPECT_TRUE(json["total_seconds"].is_null());
}

TEST(JsonText, NamesThatAreNoUtf8AreNoFault) {
  EXPECT_EQ(JsonText({{"name", "a\xff"}}), "{\"name\":\"a\xef\xbf\xbd\"}");
}

}  // namespace
}  // namespace curvereg
