// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A disk that can be filled up.
#ifndef CURVEREG_TESTS_SERVER_STORE_SMALL_DISK_H_
#define CURVEREG_TESTS_SERVER_STORE_SMALL_DISK_H_

#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/testing/test_data.h"

namespace curvereg::testing {

// A file system of its own in memory, in a folder of the test; gone with this.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& size) : options_("size=" + size) {}  // "4m"
  ~SmallDisk() {
    if (is_mounted_) {
      EXPECT_EQ(umount2(folder_.path().c_str(), MNT_DETACH), 0) << std::strerror(errno);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  // Empty, or why it cannot be had: then the test is to be skipped.
  std::string Mount() {
    is_mounted_ = mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, options_.c_str()) == 0;
    return is_mounted_ ? "" : std::string("cannot mount a small file system: ") + std::strerror(errno);
  }

  // Takes all that is free but `spare` bytes.
  void FillUp(std::size_t spare) {
    const std::size_t free = std::filesystem::space(folder_.path()).available;
    std::ofstream(File("filler"), std::ios::binary) << std::string(free - spare, 'f');
  }
  void MakeRoom() { std::filesystem::remove(File("filler")); }

  const std::string& path() const { return folder_.path(); }
  std::string File(const std::string& name) const { return folder_.File(name); }

 private:
  const std::string options_;
  TemporaryFolder folder_;
  bool is_mounted_ = false;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_SERVER_STORE_SMALL_DISK_H_
