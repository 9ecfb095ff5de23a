// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One scan of a world: where each beam hits, and all that a real scanner adds to or loses of it.
#ifndef CURVEREG_SIM_SCANNER_H_
#define CURVEREG_SIM_SCANNER_H_

#include <cstdint>

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"
#include "sim/scan_pattern.h"
#include "sim/world.h"

namespace curvereg::sim {

// The sensor drives on while it scans; each point stays in the sensor frame of its own moment, uncompensated, and the
// scan's pose is that of its first beam. Off while both speeds are zero.
struct ScanMotion {
  double duration_s = 40.0;
  double forward_mps = 0.0;     // along the sensor's x
  double yaw_rate_radps = 0.0;  // about the sensor's z
};

struct ScannerOptions {
  ScanPattern pattern = {};
  double min_range_m = 0.5;
  double max_range_m = 80.0;
  double noise_m = 0.015;            // standard deviation of the range at the sensor ...
  double noise_per_m = 0.0002;       // ... and what each metre of range adds to it
  double beam_jitter_rad = 0.0;      // deviation of the true direction, each of two axes, from the reported one
  double grazing_cosine = 0.02;      // returns thin out in proportion where the cosine of incidence falls below it
  double dropout_fraction = 0.0;     // of all returns, lost at random
  double outlier_fraction = 0.0;     // of all returns: the range is uniform from min_range to 1.5 times the true one
  double mixed_edge_fraction = 0.0;  // of all beams: half of the spot falls mixed_edge_rad aside; where that is another
                                     // surface, the range is a mixture of both
  double mixed_edge_rad = 0.002;
  double keep_fraction = 1.0;  // of all beams, chosen at random
  ScanMotion motion = {};
};

// The returns of one sweep in beam order, sensor frame, float32; beams without a return are left out. The points
// depend on the arguments alone, not on threads; `key` names the scan's random numbers.
Scan SimulateScan(const World& world, const RigidTransform& T_world_sensor, const ScannerOptions& options,
                  uint64_t key);

}  // namespace curvereg::sim

#endif  // CURVEREG_SIM_SCANNER_H_
