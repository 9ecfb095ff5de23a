// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The one place that catches exceptions of libraries, above all std::bad_alloc. Our code throws none.
#ifndef CURVEREG_SERVER_SCHEDULING_CAUGHT_H_
#define CURVEREG_SERVER_SCHEDULING_CAUGHT_H_

#include <exception>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace curvereg::server {

// What `work` returns; INTERNAL when it threw.
template <typename Work>
absl::Status Caught(const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("a library threw: ", error.what()));
  }
}

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCHEDULING_CAUGHT_H_
