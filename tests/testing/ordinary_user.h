// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_TESTING_ORDINARY_USER_H_
#define CURVEREG_TESTS_TESTING_ORDINARY_USER_H_

#include <unistd.h>

namespace curvereg::testing {

// Takes root's rights from the process while it lives, so that permissions are in force; other users keep theirs.
class OrdinaryUser {
 public:
  OrdinaryUser() {
    if (is_root_) is_ordinary_ = seteuid(65534) == 0;
  }
  ~OrdinaryUser() {
    if (is_root_ && is_ordinary_) is_ordinary_ = seteuid(0) != 0;
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

  // False when the rights could not be given up: the test skips.
  bool is_ordinary() const { return is_ordinary_; }

 private:
  bool is_root_ = geteuid() == 0;
  bool is_ordinary_ = !is_root_;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_ORDINARY_USER_H_
