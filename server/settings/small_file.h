// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_SERVER_SETTINGS_SMALL_FILE_H_
#define CURVEREG_SERVER_SETTINGS_SMALL_FILE_H_

#include <string>

#include "absl/status/statusor.h"

namespace curvereg::server {

// The whole of a file of settings, tokens or certificates (at most 1 MiB). Errors name the file.
absl::StatusOr<std::string> ReadSmallFile(const std::string& path);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SETTINGS_SMALL_FILE_H_
