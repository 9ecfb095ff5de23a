// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Disk space held back for the moment when the disk is full: deleting writes to the log before it frees anything.
#ifndef CURVEREG_SERVER_STORE_SPARE_SPACE_H_
#define CURVEREG_SERVER_STORE_SPARE_SPACE_H_

#include <string>

namespace curvereg::server {

// A file that holds nothing. Not shared between threads.
class SpareSpace {
 public:
  explicit SpareSpace(std::string path) : path_(std::move(path)) {}
  // Takes the space, unless it is held already or there is none.
  void Take();
  void GiveUp();

 private:
  std::string path_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_SPARE_SPACE_H_
