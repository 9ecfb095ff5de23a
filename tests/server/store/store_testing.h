// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tests of the store share.
#ifndef CURVEREG_TESTS_SERVER_STORE_STORE_TESTING_H_
#define CURVEREG_TESTS_SERVER_STORE_STORE_TESTING_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/store/scan_store.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_data.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {

// EXPECT_THAT(result, HasReason(v1::ERROR_REASON_SCAN_NOT_FOUND)).
MATCHER_P(HasReason, reason, "has the reason " + wire::ReasonName(reason)) {
  *result_listener << testing::StatusOf(arg);
  return wire::ReasonOf(testing::StatusOf(arg)) == reason;
}

// Bytes that no compression or pattern makes alike for two seeds.
inline std::string RandomBytes(std::size_t size, uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; i += 8) {
    const uint64_t number = generator();
    for (std::size_t j = i; j < std::min(i + 8, size); ++j) bytes[j] = static_cast<char>(number >> (8 * (j - i)));
  }
  return bytes;
}

inline void WriteFile(const std::string& path, const std::string& bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

inline std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void RunSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
}

inline v1::PointCloudHeader HeaderOf(const std::string& frame_id) {
  v1::PointCloudHeader header;
  header.set_frame_id(frame_id);
  header.set_point_count(7);
  header.set_encoding(v1::POINT_ENCODING_RAW);
  header.mutable_layout()->set_point_stride(12);
  header.mutable_gravity()->set_z(-1.0);
  return header;
}

inline v1::Digest DigestOf(const std::string& payload) {
  return wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, payload);
}

inline UploadDescription Describe(const std::string& id, const std::string& payload,
                                  const std::string& frame_id = "lidar") {
  return {id, HeaderOf(frame_id), payload.size(), DigestOf(payload)};
}

inline std::unique_ptr<ScanStore> OpenStore(const std::string& folder, const ScanStoreOptions& options = {}) {
  absl::StatusOr<std::unique_ptr<ScanStore>> store = ScanStore::Open(folder, options);
  EXPECT_THAT(store, testing::IsOk());
  return store.ok() ? *std::move(store) : nullptr;
}

// Uploads the whole payload and commits it.
inline absl::StatusOr<UploadWriter::Committed> Store(ScanStore& store, const UploadDescription& description,
                                                     const std::string& payload) {
  absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store.BeginUpload(description);
  if (!writer.ok()) return writer.status();
  const uint64_t offset = (*writer)->committed_offset();
  const absl::Status status = (*writer)->Append(offset, std::string_view(payload).substr(offset));
  if (!status.ok()) return status;
  return (*writer)->Commit(5, "content");
}

// Paths of the regular files below a folder, sorted.
inline std::vector<std::string> FilesBelow(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace curvereg::server

#endif  // CURVEREG_TESTS_SERVER_STORE_STORE_TESTING_H_
