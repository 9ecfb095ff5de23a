// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/point_output.h"

#include <string>
#include <string_view>

#include "files/text_fields.h"

namespace curvereg {

void AppendPackedPoints(const Scan& scan, AtomicFile& file) {
  static_assert(sizeof(Eigen::Vector3f) == 12, "points are copied as they lie in memory");
  if (scan.points.empty()) return;
  file.Append(std::string_view(reinterpret_cast<const char*>(scan.points.data()), scan.points.size() * 12));
}

void AppendTextPoints(const Scan& scan, char separator, AtomicFile& file) {
  std::string line;
  for (const Eigen::Vector3f& point : scan.points) {
    line.clear();
    AppendFloat(point.x(), line);
    line += separator;
    AppendFloat(point.y(), line);
    line += separator;
    AppendFloat(point.z(), line);
    line += '\n';
    file.Append(line);
  }
}

}  // namespace curvereg
