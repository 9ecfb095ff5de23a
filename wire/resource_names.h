// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The names of what a server keeps: `scans/{scan}`, `uploads/{upload}`, `traverses/{traverse}`. The only place that
// knows how they are composed.
#ifndef CURVEREG_WIRE_RESOURCE_NAMES_H_
#define CURVEREG_WIRE_RESOURCE_NAMES_H_

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace curvereg::wire {

inline constexpr std::string_view kScanPrefix = "scans/";
inline constexpr std::string_view kUploadPrefix = "uploads/";
inline constexpr std::string_view kTraversePrefix = "traverses/";

// The name of the resource with this id. The id is not checked.
std::string ScanName(std::string_view scan_id);
std::string UploadName(std::string_view upload_id);
std::string TraverseName(std::string_view traverse_id);

// The id in a name. INVALID_FIELD naming `field` when the prefix is missing or the id is not valid: a scan's is 32
// lower-case hexadecimal digits, those of uploads and traverses are client-chosen ids.
absl::StatusOr<std::string> ScanIdOf(std::string_view name, std::string_view field);
absl::StatusOr<std::string> UploadIdOf(std::string_view name, std::string_view field);
absl::StatusOr<std::string> TraverseIdOf(std::string_view name, std::string_view field);

bool IsScanName(std::string_view text);
// 1 to 64 of a-z, 0-9 and '-': the ids that clients choose. Safe as a file name.
bool IsClientChosenId(std::string_view text);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_RESOURCE_NAMES_H_
