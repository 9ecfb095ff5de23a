// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/methods/registration_names.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;

TEST(RegistrationNames, MethodsHaveTheDocumentedNames) {
  std::vector<std::string> names;
  for (const Method method : AllMethods()) names.emplace_back(MethodName(method));
  EXPECT_THAT(names, ElementsAre("curvelet", "paper", "fpfh-sac-ia", "harris3d-fpfh", "icp"));
}

TEST(RegistrationNames, EveryMethodIsFoundByItsName) {
  for (const Method method : AllMethods()) EXPECT_EQ(MethodFromName(MethodName(method)), method);
}

TEST(RegistrationNames, OtherNamesAreNoMethod) {
  EXPECT_FALSE(MethodFromName("").has_value());
  EXPECT_FALSE(MethodFromName("Curvelet").has_value());
  EXPECT_FALSE(MethodFromName("curvelet ").has_value());
  EXPECT_FALSE(MethodFromName("unknown").has_value());
}

TEST(RegistrationNames, ReasonsAreDistinctAndLowerCase) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(Reason::kDeadline); ++i) {
    const std::string_view name = ReasonName(static_cast<Reason>(i));
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string_view::npos) << name;
    EXPECT_NE(name, "unknown");
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(ReasonName(Reason::kOverlapTooLow), "overlap_too_low");
}

}  // namespace
}  // namespace curvereg
