// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapping/link_registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/register_scans.h"
#include "tests/testing/matchers.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::DriveScans;
using ::testing::ElementsAre;
using testing::HasCode;
using testing::IsOk;

TEST(LinkedPartnersTest, OnBothSidesAcceptedOrNot) {
  Traverse traverse;
  traverse.links = {{3, 1, LinkKind::kTracking, {}}, {5, 3, LinkKind::kNeighbour, {}}, {5, 4, LinkKind::kTracking, {}}};
  EXPECT_THAT(LinkedPartners(traverse, 3), ElementsAre(1U, 5U));
  EXPECT_TRUE(LinkedPartners(traverse, 9).empty());
}

TEST(RegisterLinkTest, IsTheRegistrationWithTheRequestsPrior) {
  DriveScans drive(*sim::Simulation::Create(testing::SmallDrive(2)));
  RegistrationOptions options;
  options.prior = Prior{drive.TrueMotion(1, 0), std::nullopt};  // of another pair; not to be used
  const Prior prior{drive.TrueMotion(0, 1), Matrix6d(1e-2 * Matrix6d::Identity())};
  const auto link = RegisterLink(*drive.Get(1), {1, 0, LinkKind::kNeighbour, prior}, drive.Loader(), options, {});
  ASSERT_THAT(link, IsOk());
  EXPECT_EQ(link->source, 1U);
  EXPECT_EQ(link->target, 0U);
  EXPECT_EQ(link->kind, LinkKind::kNeighbour);
  EXPECT_TRUE(link->result.verdict.accepted);
  options.prior = prior;
  const auto result = RegisterPreparedScans(*drive.Get(1), *drive.Get(0), options);
  ASSERT_THAT(result, IsOk());
  EXPECT_EQ(link->result.T_target_source->matrix(), result->T_target_source->matrix());
  EXPECT_EQ(link->result.options_digest, result->options_digest);
}

TEST(RegisterLinkTest, LittleTimeRejectsButNoTimeIsAnError) {
  DriveScans drive(*sim::Simulation::Create(testing::SmallDrive(2)));
  RegistrationOptions options;
  options.time_budget_s = 1e-6;
  const LinkRequest request{1, 0, LinkKind::kTracking, std::nullopt};
  const auto link = RegisterLink(*drive.Get(1), request, drive.Loader(), options, {});
  ASSERT_THAT(link, IsOk());
  EXPECT_FALSE(link->result.verdict.accepted);
  EXPECT_THAT(link->result.verdict.reasons, ::testing::Contains(Reason::kDeadline));
  EXPECT_THAT(RegisterLink(*drive.Get(1), request, drive.Loader(), {}, {{}, std::chrono::steady_clock::now()}),
              HasCode(absl::StatusCode::kDeadlineExceeded));
  EXPECT_THAT(RegisterLink(*drive.Get(1), {9, 7, LinkKind::kTracking, std::nullopt}, drive.Loader(), {}, {}),
              HasCode(absl::StatusCode::kNotFound));
}

}  // namespace
}  // namespace curvereg
