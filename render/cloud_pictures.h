// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Pictures of two clouds laid over each other.
#ifndef CURVEREG_RENDER_CLOUD_PICTURES_H_
#define CURVEREG_RENDER_CLOUD_PICTURES_H_

#include "core/base/image.h"
#include "core/base/rigid_transform.h"
#include "core/scan/scan.h"
#include "render/png.h"

namespace curvereg {

enum class Projection {
  kFromAbove,   // x to the right, y upwards
  kFromTheSide  // x to the right, z upwards
};

// The target in blue and the source, moved by T_target_source, in orange on white; dark where both are. Axes are those
// of the target frame, the window holds the middle 98 % of the target along each axis, its longer side is 800 px.
// Points that are not finite are skipped; without any finite point the picture is white.
Image<Rgb> OverlayPicture(const Scan& source, const Scan& target, const RigidTransform& T_target_source,
                          Projection projection);

}  // namespace curvereg

#endif  // CURVEREG_RENDER_CLOUD_PICTURES_H_
