// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_TESTING_TEST_DATA_H_
#define CURVEREG_TESTS_TESTING_TEST_DATA_H_

#include <optional>
#include <string>

namespace curvereg::testing {

// Path of a file or folder in tests/data.
std::string TestDataPath(const std::string& relative);

// Folder of a real data set (e.g. "b4_small_gicp_hdl32"): $CURVEREG_TEST_DATA, else ../shared/data beside the checkout.
// Nullopt when it is not on this machine; a test then calls GTEST_SKIP() << "..." with the reason.
std::optional<std::string> RealDataPath(const std::string& dataset);

// A new empty folder below the system's temporary folder; removed with all it holds at destruction.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_TEST_DATA_H_
