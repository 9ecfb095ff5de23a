// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a scanner looks: the direction of each beam, a pure function of its number. Sensor frame: x ahead, y left,
// z up; azimuth counter-clockwise from x, elevation up from the xy plane.
#ifndef CURVEREG_SIM_SCAN_PATTERN_H_
#define CURVEREG_SIM_SCAN_PATTERN_H_

#include <Eigen/Core>

namespace curvereg::sim {

enum class PatternKind {
  kRegular,  // columns x rows of equal steps, column after column, each from below to above
  kSpiral,   // turns about z while the elevation creeps from below to above: `rows` turns of `columns` beams
  kRosette,  // petals in a cone ahead, as a pair of rotating prisms draws them; never the same petal twice
};

struct ScanPattern {
  PatternKind kind = PatternKind::kRegular;
  int columns = 720;
  int rows = 361;
  double elevation_min_rad = -0.7156;  // -41 degrees; regular and spiral
  double elevation_max_rad = 0.0698;   // +4 degrees; regular and spiral
  double rosette_half_angle_rad = 0.61;
  double rosette_elevation_rad = -0.25;  // of the cone's axis

  int num_beams() const { return columns * rows; }
};

// Unit direction of beam `index` in [0, num_beams).
Eigen::Vector3d BeamDirection(const ScanPattern& pattern, int index);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_SCAN_PATTERN_H_
