// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The points of a scan as the bodies of the written formats.
#ifndef CURVEREG_FILES_POINT_OUTPUT_H_
#define CURVEREG_FILES_POINT_OUTPUT_H_

#include "core/scan/scan.h"
#include "files/atomic_file.h"

namespace curvereg {

// 12 bytes per point: little-endian float32 x y z, bit for bit.
void AppendPackedPoints(const Scan& scan, AtomicFile& file);

// A line per point; the shortest digits that read back as the same float32, "nan" for every NaN.
void AppendTextPoints(const Scan& scan, char separator, AtomicFile& file);

}  // namespace curvereg

#endif  // CURVEREG_FILES_POINT_OUTPUT_H_
