// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Which files of a folder are scans, and in which order.
#ifndef CURVEREG_FILES_SCAN_FILES_H_
#define CURVEREG_FILES_SCAN_FILES_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace curvereg {

// Paths of the files with the ending of a cloud, in name order. Hidden files, notes (README.txt, poses.txt,
// odometry.txt, ...) and the file `except` (empty: none) are left out, and text files where there are others. Empty
// where there are none. Errors of reading the folder; NOT_FOUND: no such folder.
absl::StatusOr<std::vector<std::string>> ScanFilesIn(const std::string& folder, const std::string& except = "");

// The order of names: without their endings, or a.pcd would come after a-b.pcd.
bool ComesBefore(const std::string& a, const std::string& b);

}  // namespace curvereg

#endif  // CURVEREG_FILES_SCAN_FILES_H_
