// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Free space of a scan: the nearest and farthest return per direction, on the six faces of a cube about the sensor.
// Beams passed through everything in front of their returns. A point of another scan that lies there under a pose
// contradicts the pose. The visibility test is that of occupancy grids [Moravec 1985], kept as ranges per direction
// instead of cells: no grid of the volume, no trigonometry, any attitude.
#ifndef CURVEREG_CORE_SCAN_FREE_SPACE_H_
#define CURVEREG_CORE_SCAN_FREE_SPACE_H_

#include <Eigen/Core>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/scan/cube_map.h"

namespace curvereg {

struct FreeSpaceOptions {
  int max_bins_per_side = 96;      // of a cube face: 1.2 degrees; fewer for sparse scans, so that bins are not empty
  double points_per_bin = 3.0;     // aimed at, on the faces that the sensor sees
  double margin_m = 0.25;          // a point must be this much nearer than all returns to contradict,
  double margin_per_metre = 0.02;  // plus this much per metre of range
};

// Immutable after construction; safe to share.
class FreeSpace {
 public:
  FreeSpace() = default;
  // Points in the sensor frame; those not finite or at the origin are skipped. Incomplete after a stop request.
  explicit FreeSpace(const std::vector<Eigen::Vector3f>& points, const FreeSpaceOptions& options = {},
                     const Stop& stop = {});

  enum class Answer { kUnseen, kAgrees, kViolates };
  // Point in the sensor frame. kUnseen: direction never measured, or hidden behind what was.
  Answer Ask(const Eigen::Vector3f& point) const;
  // Heap memory that it holds.
  size_t MemoryBytes() const { return bins_.capacity() * sizeof(Interval); }

 private:
  FreeSpaceOptions options_;
  CubeMap cube_;
  struct Interval {
    float nearest, farthest;  // [m]; nearest > farthest where nothing was measured
    bool measured;            // in this very bin, not only in a neighbour: beams without a return prove nothing
  };
  std::vector<Interval> bins_;  // of cube_, each widened to its neighbours
};

struct FreeSpaceAgreement {
  int agreeing = 0;
  int violating = 0;
  int unknown = 0;
  // agreeing / (agreeing + violating), 0 when nothing was answered.
  double Agreement() const;
  // agreeing / all, 0 for no points: the share of the points that the other scan saw too.
  double Overlap() const;
};

// Asks for each point of the other scan, moved by T_scan_points.
FreeSpaceAgreement AskAll(const FreeSpace& free_space, const RigidTransform& T_scan_points,
                          const std::vector<Eigen::Vector3f>& points);

}  // namespace curvereg

#endif  // CURVEREG_CORE_SCAN_FREE_SPACE_H_
