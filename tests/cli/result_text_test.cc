// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/result_text.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvereg::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(RegistrationText, ARejectionShowsNoTransformItDoesNotHave) {
  const std::string text = RegistrationText(RegistrationResult{});
  EXPECT_THAT(text, HasSubstr("rejected: not_run"));
  EXPECT_THAT(text, HasSubstr("transform    none"));
  EXPECT_THAT(text, Not(HasSubstr("1.000000000")));
  EXPECT_THAT(text, Not(HasSubstr("overlap")));  // not computed
}

TEST(RegistrationText, ShowsPoseSigmaAndDegeneracy) {
  RegistrationResult result;
  result.T_target_source = Eigen::Translation3d(3.0, 4.0, 0.0) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ());
  result.covariance = Matrix6d::Identity() * 1e-4;
  result.verdict = {.accepted = true, .reasons = {}};
  result.degenerate_directions.push_back(
      {.direction = Vector6d::Unit(4), .sigma = std::numeric_limits<double>::infinity()});
  result.evidence.overlap_source = 0.75;
  result.stage_times = {{"match", 0.002}};
  const std::string text = RegistrationText(result);
  EXPECT_THAT(text, HasSubstr("verdict      accepted"));
  EXPECT_THAT(text, HasSubstr("motion       5.0000 m, 0.1000 rad (5.730 deg)"));
  EXPECT_THAT(text, HasSubstr("rotation 0.01 0.01 0.01 rad"));
  EXPECT_THAT(text, HasSubstr("translation (0.00 1.00 0.00), sigma inf"));
  EXPECT_THAT(text, HasSubstr("0.75"));
  EXPECT_THAT(text, HasSubstr("2.00 ms"));
}

TEST(EvaluationText, OneLinePerMethodAndDashesForNothing) {
  Evaluation evaluation{.dataset = "yard", .methods = {}};
  evaluation.methods.emplace_back().summary = Summarise({});
  evaluation.methods.back().summary.negatives = 3;
  const std::string text = EvaluationText(evaluation);
  EXPECT_THAT(text, HasSubstr("yard\n"));
  EXPECT_THAT(text, HasSubstr("curvelet          0     0"));
  EXPECT_THAT(text, HasSubstr(" - "));
  EXPECT_THAT(text, HasSubstr("0 of 3 negative pairs accepted"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace curvereg::cli
