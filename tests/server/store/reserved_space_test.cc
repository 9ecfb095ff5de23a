// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/reserved_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/testing/matchers.h"
#include "tests/testing/test_data.h"

namespace curvereg::server {
namespace {

using testing::HasCode;
using testing::IsOk;

constexpr uint64_t kReservedBytes = uint64_t{16} << 20;

class ReservedSpaceTest : public ::testing::Test {
 protected:
  bool IsHeld() const { return std::filesystem::exists(path_) && std::filesystem::file_size(path_) == kReservedBytes; }

  testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("spare");
  ReservedSpace space_{path_};
};

TEST_F(ReservedSpaceTest, IsTakenAndGivenUp) {
  EXPECT_FALSE(IsHeld());
  space_.Take();
  EXPECT_TRUE(IsHeld());
  space_.Take();
  EXPECT_TRUE(IsHeld());
  space_.GiveUp();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(ReservedSpaceTest, StaysWhereTheDiskHasRoom) {
  space_.Take();
  int num_runs = 0;
  const auto work = [&] {
    ++num_runs;
    EXPECT_TRUE(IsHeld());
    return absl::OkStatus();
  };
  EXPECT_THAT(space_.Use(work), IsOk());
  EXPECT_EQ(num_runs, 1);
  EXPECT_TRUE(IsHeld());
}

TEST_F(ReservedSpaceTest, IsGivenUpForASecondRunOnAFullDiskAndTakenAgain) {
  space_.Take();
  int num_runs = 0;
  const auto work = [&] {
    EXPECT_EQ(IsHeld(), num_runs == 0);
    return ++num_runs == 1 ? absl::ResourceExhaustedError("full") : absl::OkStatus();
  };
  EXPECT_THAT(space_.Use(work), IsOk());
  EXPECT_EQ(num_runs, 2);
  EXPECT_TRUE(IsHeld());
}

TEST_F(ReservedSpaceTest, OtherErrorsAreNotTriedAgain) {
  int num_runs = 0;
  const auto work = [&] {
    ++num_runs;
    return absl::NotFoundError("no such scan");
  };
  EXPECT_THAT(space_.Use(work), HasCode(absl::StatusCode::kNotFound));
  EXPECT_EQ(num_runs, 1);
  EXPECT_TRUE(IsHeld());
}

}  // namespace
}  // namespace curvereg::server
