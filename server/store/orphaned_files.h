// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Files of a store that its database does not know, though they may hold what was acknowledged: a database that has
// lost its newest changes looks like that. They are kept for the operator, in a folder of their own.
#ifndef CURVEREG_SERVER_STORE_ORPHANED_FILES_H_
#define CURVEREG_SERVER_STORE_ORPHANED_FILES_H_

#include <cstdint>
#include <string>
#include <utility>

#include "absl/status/status.h"

namespace curvereg::server {

class OrphanedFiles {
 public:
  // The folder, on the file system of the store, is made when it is needed.
  explicit OrphanedFiles(std::string folder) : folder_(std::move(folder)) {}

  // Moves a file there, as `name` or, where that is taken, as `name`.2 and so on.
  absl::Status Take(const std::string& path, const std::string& name);
  uint64_t num_taken() const { return num_taken_; }

 private:
  std::string folder_;
  uint64_t num_taken_ = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_ORPHANED_FILES_H_
