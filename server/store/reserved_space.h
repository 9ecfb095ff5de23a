// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Disk space held back for the moment when the disk is full: deleting writes to the log before it frees anything.
#ifndef CURVEREG_SERVER_STORE_RESERVED_SPACE_H_
#define CURVEREG_SERVER_STORE_RESERVED_SPACE_H_

#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/status.h"

namespace curvereg::server {

// A file that holds nothing. Safe to use from several threads.
class ReservedSpace {
 public:
  explicit ReservedSpace(std::string path) : path_(std::move(path)) {}

  // Takes the space, unless it is held already or there is none. Both: while nobody else uses it.
  void Take();
  void GiveUp();

  // Runs `work`, a deletion for example. Where the disk is full (RESOURCE_EXHAUSTED), gives the space up and runs it
  // again. Then takes the space. One at a time.
  absl::Status Use(const std::function<absl::Status()>& work);

 private:
  const std::string path_;
  std::mutex mutex_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_RESERVED_SPACE_H_
