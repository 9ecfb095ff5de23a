// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/argument_parsing.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "tests/testing/test_data.h"

namespace curvereg::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RigidTransform QuarterTurn() {
  return Eigen::Translation3d(1.0, -2.0, 3.0) * Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ());
}

TEST(ParseTransform, EveryWayToWriteTheSameTransform) {
  for (const char* text : {"0 -1 0 1  1 0 0 -2  0 0 1 3  0 0 0 1", "0,-1,0,1,1,0,0,-2,0,0,1,3",
                           "1 -2 3 0 0 0.70710678 0.70710678", "12.5 1 -2 3 0 0 0.70710678 0.70710678"}) {
    const auto T = ParseTransform(text);
    ASSERT_TRUE(T.ok()) << text << ": " << T.status();
    EXPECT_TRUE(T->isApprox(QuarterTurn(), 1e-6)) << text;
    EXPECT_TRUE(IsRigid(*T, 1e-12)) << text;
  }
}

TEST(ParseTransform, ReadsAFileWithComments) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("prior.txt")) << "# T_target_source\n0 -1 0 1\n1 0 0 -2 # second row\n0 0 1 3\n0 0 0 1\n";
  const auto T = ParseTransform(folder.File("prior.txt"));
  ASSERT_TRUE(T.ok()) << T.status();
  EXPECT_TRUE(T->isApprox(QuarterTurn(), 1e-12));
}

TEST(ParseTransform, RefusesWhatIsNotRigid) {
  for (const char* text : {"1 2 3", "0 0 0 0 0 0 0", "nan 0 0 0 0 0 1", "1 0 0 0 0 0 2",
                           "2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1",    // scaled
                           "-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1",   // mirrored
                           "1 0 0 0  0 1 0 0  0 0 1 0  0 0 1 1",    // projective
                           "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"}) {  // too many
    EXPECT_FALSE(ParseTransform(text).ok()) << text;
  }
}

TEST(ParseTransform, NamesWhatIsNoFile) {
  EXPECT_EQ(ParseTransform("no/such/file").status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(ParseTransform("no/such/file").status().message()), HasSubstr("no/such/file"));
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ParseTransform(folder.path()).status().code(), absl::StatusCode::kInvalidArgument);
  std::ofstream(folder.File("text")) << "hello world\n";
  EXPECT_EQ(ParseTransform(folder.File("text")).status().code(), absl::StatusCode::kInvalidArgument);
  std::ofstream(folder.File("empty"));
  EXPECT_EQ(ParseTransform(folder.File("empty")).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(ParseDirection, ThreeNumbersNotAllZero) {
  const auto down = ParseDirection("0,0,-9.81");
  ASSERT_TRUE(down.ok()) << down.status();
  EXPECT_EQ(*down, Eigen::Vector3d(0.0, 0.0, -9.81));
  for (const char* text : {"", "0,0,0", "1,2", "1,2,3,4", "a,b,c", "inf,0,0"}) EXPECT_FALSE(ParseDirection(text).ok());
}

TEST(ParsePriorSigma, SquaresOntoTheDiagonal) {
  const auto covariance = ParsePriorSigma("0.1,2");
  ASSERT_TRUE(covariance.ok()) << covariance.status();
  EXPECT_TRUE(
      covariance->isApprox(Matrix6d((Vector6d() << 0.01, 0.01, 0.01, 4.0, 4.0, 4.0).finished().asDiagonal()), 1e-12));
  for (const char* text : {"0.1", "0,1", "-1,1", "1,1,1"}) EXPECT_FALSE(ParsePriorSigma(text).ok()) << text;
}

TEST(Checks, TellWhatIsExpected) {
  EXPECT_EQ(CheckSeconds("0.0001"), "");
  EXPECT_EQ(CheckSeconds("1e9"), "");
  for (const char* text : {"", "0", "-1", "nan", "inf", "1e10", "1e300", "1e999", "5s", " 5"}) {
    EXPECT_THAT(CheckSeconds(text), HasSubstr(absl::StrCat("'", text, "'")));
  }
  EXPECT_EQ(CheckNotNegative("18446744073709551615"), "");
  for (const char* text : {"", "-1", "1.5", "18446744073709551616"}) EXPECT_NE(CheckNotNegative(text), "") << text;
}

TEST(ParseMethods, NamesInOrder) {
  const auto methods = ParseMethods("icp,curvelet");
  ASSERT_TRUE(methods.ok()) << methods.status();
  EXPECT_THAT(*methods, ElementsAre(Method::kIcp, Method::kCurvelet));
}

TEST(ParseMethods, ErrorsTellWhatThereIs) {
  EXPECT_THAT(std::string(ParseMethods("icp,magic").status().message()),
              HasSubstr("unknown method 'magic'; methods: curvelet, paper"));
  EXPECT_FALSE(ParseMethods("").ok());
  EXPECT_FALSE(ParseMethods("icp,").ok());
  EXPECT_THAT(std::string(ParseMethods("icp,icp").status().message()), HasSubstr("twice"));
}

}  // namespace
}  // namespace curvereg::cli
