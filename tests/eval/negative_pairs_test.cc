// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/negative_pairs.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;

class NegativePairsTest : public ::testing::Test {
 protected:
  void Write(const std::string& text, const std::string& name = "negatives.txt") {
    std::ofstream(folder_.File(name)) << text;
  }
  absl::StatusOr<std::vector<NegativePair>> Load() const {
    Dataset dataset;
    dataset.folder = folder_.path();
    dataset.scan_names = {"a", "b", "c"};
    return LoadNegativePairs(dataset);
  }
  testing::TemporaryFolder folder_;
};

TEST_F(NegativePairsTest, NoFileMeansNoPairs) {
  const auto pairs = Load();
  ASSERT_TRUE(pairs.ok()) << pairs.status();
  EXPECT_TRUE(pairs->empty());
}

TEST_F(NegativePairsTest, ReadsPairsAndSkipsComments) {
  Write("# source target\na b\n\n  c\ta # far apart\r\n");
  const auto pairs = Load();
  ASSERT_TRUE(pairs.ok()) << pairs.status();
  ASSERT_EQ(pairs->size(), 2u);
  EXPECT_EQ((*pairs)[1].source, "c");
  EXPECT_EQ((*pairs)[1].target, "a");
}

TEST_F(NegativePairsTest, ErrorsNameFileAndLine) {
  Write("a b\na b c\n");
  EXPECT_THAT(std::string(Load().status().message()), HasSubstr("negatives.txt:2"));
  Write("a x\n");
  EXPECT_THAT(std::string(Load().status().message()), HasSubstr("no scan is named x"));
}

TEST_F(NegativePairsTest, TheOldFileNameIsReadWhereTheNewOneIsMissing) {
  Write("b c\n", "strangers.txt");
  const auto old_pairs = Load();
  ASSERT_TRUE(old_pairs.ok()) << old_pairs.status();
  ASSERT_EQ(old_pairs->size(), 1U);
  EXPECT_EQ((*old_pairs)[0].source, "b");
  EXPECT_TRUE(IsOldNegativePairsFile(NegativePairsFile(folder_.path())));
  Write("a b\na c\n");
  EXPECT_FALSE(IsOldNegativePairsFile(NegativePairsFile(folder_.path())));
  EXPECT_EQ(Load()->size(), 2U);
}

}  // namespace
}  // namespace curvereg
