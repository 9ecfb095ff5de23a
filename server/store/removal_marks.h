// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tells files whose removal was interrupted from files that a database has lost: a file is marked, by a second name
// (hard link) in a folder of its own, before the row that names it goes. Marks are not forced to disk: after a loss of
// power a file is set aside rather than removed. The same where the file system knows no second names or has no room.
#ifndef CURVEREG_SERVER_STORE_REMOVAL_MARKS_H_
#define CURVEREG_SERVER_STORE_REMOVAL_MARKS_H_

#include <string>
#include <utility>

#include "absl/status/status.h"

namespace curvereg::server {

// Safe to use from several threads as long as each name is used by one at a time.
class RemovalMarks {
 public:
  // The folder, on the file system of the store, is made when it is needed.
  explicit RemovalMarks(std::string folder) : folder_(std::move(folder)) {}

  // Marks the file at `path` as `name`; an older mark of that name goes.
  void Set(const std::string& path, const std::string& name) const;
  void Clear(const std::string& name) const;
  // The file at `path` is the very one that was marked.
  bool IsSet(const std::string& path, const std::string& name) const;
  absl::Status ClearAll() const;

 private:
  std::string folder_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_REMOVAL_MARKS_H_
