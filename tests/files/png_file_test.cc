// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

TEST(WritePngFile, WritesTheEncodersBytes) {
  const testing::TemporaryFolder folder;
  const Image<Rgb> picture(4, 4, Rgb{1, 2, 3});
  ASSERT_TRUE(WritePngFile(folder.File("a.png"), picture).ok());
  std::ifstream file(folder.File("a.png"), std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), *EncodePng(picture));
}

TEST(WritePngFile, NamesTheFileItCannotWrite) {
  const testing::TemporaryFolder folder;
  const absl::Status status = WritePngFile(folder.File("no/a.png"), Image<Rgb>(4, 4));
  EXPECT_NE(std::string(status.message()).find("no/a.png"), std::string::npos);
  EXPECT_EQ(WritePngFile(folder.File("a.png"), Image<Rgb>()).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvereg
