// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Determinism: the same bytes at any thread count.
#ifndef CURVEREG_TESTS_TESTING_SAME_BYTES_H_
#define CURVEREG_TESTS_TESTING_SAME_BYTES_H_

#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <vector>

#include "core/base/parallel.h"

namespace curvereg::testing {

// Collects the bytes of a result, value after value (structs with padding field by field).
class ByteLog {
 public:
  template <typename T>
  void Add(const T* values, size_t count) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  template <typename T>
  void Add(const std::vector<T>& values) {
    Add(values.data(), values.size());
  }
  template <typename T>
  void Add(T value) {
    Add(&value, 1);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Calls compute(ByteLog&) under limits of 1, 2 and 4 threads.
template <typename Compute>
void ExpectSameBytesAtAnyThreadCount(const Compute& compute) {
  std::string serial;
  for (const int num_threads : {1, 2, 4}) {
    ByteLog log;
    WithThreadLimit(num_threads, [&] { compute(log); });
    if (num_threads == 1) serial = log.bytes();
    EXPECT_FALSE(serial.empty());
    EXPECT_TRUE(log.bytes() == serial) << "differs with " << num_threads << " threads";
  }
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_SAME_BYTES_H_
