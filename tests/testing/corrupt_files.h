// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What every reader of files must survive.
#ifndef CURVEREG_TESTS_TESTING_CORRUPT_FILES_H_
#define CURVEREG_TESTS_TESTING_CORRUPT_FILES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

namespace curvereg::testing {

// Calls parse(bytes) on a copy in a block of exactly its size, where a sanitizer sees every byte read too many.
template <typename Parse>
auto ParseExact(const Parse& parse, std::string_view bytes) {
  const auto block = std::make_unique<char[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), block.get());
  return parse(std::string_view(block.get(), bytes.size()));
}

// Every beginning of `bytes` shorter than `size` must be refused, with a message.
template <typename Parse>
void ExpectTruncationsRefused(const Parse& parse, std::string_view bytes, std::size_t size) {
  for (std::size_t length = 0; length < size; ++length) {
    const auto result = ParseExact(parse, bytes.substr(0, length));
    EXPECT_FALSE(result.ok()) << "of " << bytes.size() << " bytes the first " << length << " were taken";
    EXPECT_FALSE(result.status().message().empty());
  }
}

// With each byte in turn set to each of a few values: any answer, but no crash and at most `max_points` points.
template <typename Parse>
void ExpectCorruptionsSurvived(const Parse& parse, std::string_view bytes, std::size_t max_points) {
  for (std::size_t position = 0; position < bytes.size(); ++position) {
    for (const char value : {'\0', '\x7f', '\x80', '\xff', '9', '-', ' ', '\n'}) {
      std::string changed(bytes);
      changed[position] = value;
      const auto result = ParseExact(parse, changed);
      if (result.ok()) {
        EXPECT_LE(result->points.size(), max_points);
      }
    }
  }
}

// The bytes of a number as they lie in a little-endian file.
template <typename T>
std::string Bytes(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

template <typename T>
std::string BigEndianBytes(T value) {
  std::string bytes = Bytes(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline void WriteBytes(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_CORRUPT_FILES_H_
