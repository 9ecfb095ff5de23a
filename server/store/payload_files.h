// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Payloads on disk: one file for each, named by the XXH3_128 digest of its bytes, in folders by the first byte.
// Files never change once they have their name. Safe to use from several threads as long as Add and Remove of one
// digest are not called at once.
#ifndef CURVEREG_SERVER_STORE_PAYLOAD_FILES_H_
#define CURVEREG_SERVER_STORE_PAYLOAD_FILES_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/store_file.h"

namespace curvereg::server {

// Digests are the 16 raw bytes.
class PayloadFiles {
 public:
  // `folder` exists.
  explicit PayloadFiles(std::string folder) : folder_(std::move(folder)) {}

  // Digests of all files that are named like payloads.
  absl::StatusOr<std::vector<std::string>> List() const;

  std::string PathOf(const std::string& digest) const;
  // What the file system tells, unread. None: no such file.
  std::optional<FileInfo> LookAt(const std::string& digest) const;
  // False: none there, or of another size.
  bool HasSize(const std::string& digest, uint64_t bytes) const;
  enum class State { kAbsent, kDamaged, kIntact };
  // Reads the whole file and checks its digest.
  State Check(const std::string& digest, uint64_t bytes) const;

  // Gives the file at `source`, already on disk, a payload's name as well; durable when done. The source keeps its
  // name too, so that whoever is stopped here has lost nothing. With `replace` a file of that name gives way, else it
  // stays.
  absl::Status Add(const std::string& digest, const std::string& source, bool replace);
  absl::Status Remove(const std::string& digest);
  // Fewer bytes at the end.
  absl::StatusOr<std::string> Read(const std::string& digest, uint64_t offset, uint64_t size) const;

 private:
  std::string FolderOf(const std::string& digest) const;
  bool HasDigest(const std::string& digest, uint64_t bytes) const;

  std::string folder_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_PAYLOAD_FILES_H_
