// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How a traverse changes: the steps of tracking only read it, these functions make their results its own.
#ifndef CURVEREG_CORE_MAPPING_TRAVERSE_CHANGES_H_
#define CURVEREG_CORE_MAPPING_TRAVERSE_CHANGES_H_

#include <optional>

#include "core/mapping/revise_traverse.h"
#include "core/mapping/track_scan.h"
#include "core/mapping/trajectory.h"
#include "core/methods/registration_options.h"

namespace curvereg {

// The scan becomes the last of the traverse.
void AppendScan(Traverse& traverse, const TrackedScan& tracked, const std::optional<Prior>& prior);
// Makes the revised poses the traverse's own and counts its version up when any changed.
void ApplyRevision(Traverse& traverse, const TraverseRevision& revision);

}  // namespace curvereg

#endif  // CURVEREG_CORE_MAPPING_TRAVERSE_CHANGES_H_
