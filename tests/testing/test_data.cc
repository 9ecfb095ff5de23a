// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/test_data.h"

#include <cstdlib>
#include <filesystem>

namespace curvereg::testing {

std::string TestDataPath(const std::string& relative) {
  return std::string(CURVEREG_SOURCE_DIR) + "/tests/data/" + relative;
}

std::optional<std::string> RealDataPath(const std::string& dataset) {
  const char* root = std::getenv("CURVEREG_TEST_DATA");
  const std::filesystem::path folder =
      root != nullptr ? std::filesystem::path(root)
                      : std::filesystem::path(CURVEREG_SOURCE_DIR).parent_path() / "shared" / "data";
  const std::filesystem::path path = folder / dataset;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path.string();
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "curvereg_test_XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() { std::filesystem::remove_all(path_); }

}  // namespace curvereg::testing
