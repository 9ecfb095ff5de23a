// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/strangers.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;

class StrangersTest : public ::testing::Test {
 protected:
  void Write(const std::string& text) { std::ofstream(folder_.File("strangers.txt")) << text; }
  absl::StatusOr<std::vector<StrangerPair>> Load() const {
    Dataset dataset;
    dataset.folder = folder_.path();
    dataset.scan_names = {"a", "b", "c"};
    return LoadStrangers(dataset);
  }
  testing::TemporaryFolder folder_;
};

TEST_F(StrangersTest, NoFileMeansNoStrangers) {
  const auto pairs = Load();
  ASSERT_TRUE(pairs.ok()) << pairs.status();
  EXPECT_TRUE(pairs->empty());
}

TEST_F(StrangersTest, ReadsPairsAndSkipsComments) {
  Write("# source target\na b\n\n  c\ta # far apart\r\n");
  const auto pairs = Load();
  ASSERT_TRUE(pairs.ok()) << pairs.status();
  ASSERT_EQ(pairs->size(), 2u);
  EXPECT_EQ((*pairs)[1].source, "c");
  EXPECT_EQ((*pairs)[1].target, "a");
}

TEST_F(StrangersTest, ErrorsNameFileAndLine) {
  Write("a b\na b c\n");
  EXPECT_THAT(std::string(Load().status().message()), HasSubstr("strangers.txt:2"));
  Write("a x\n");
  EXPECT_THAT(std::string(Load().status().message()), HasSubstr("no scan is named x"));
}

}  // namespace
}  // namespace curvereg
