// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Plots of two clouds in one frame.
#ifndef CURVEREG_RENDER_CLOUD_PICTURES_H_
#define CURVEREG_RENDER_CLOUD_PICTURES_H_

#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"
#include "render/plot.h"

namespace curvereg {

enum class Projection {
  kFromAbove,   // x to the right, y upwards
  kFromTheSide  // x to the right, z upwards
};

// The target in blue and the source, moved by T_target_source, in orange on white; dark where both are; an arrow of its
// colour for each sensor along its x axis. Axes are those of the target frame [m], the window holds the middle 98 % of
// the target along each axis, its longer side is 800 px, its shorter at least 120 px. Points that are not finite are
// skipped; without any finite point the plot is white. The title is the caller's.
Plot OverlayPlot(const Scan& source, const Scan& target, const RigidTransform& T_target_source, Projection projection);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_CLOUD_PICTURES_H_
