// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE: where the rover is, scan by scan. TrackScan answers quickly, FindLinks then looks for further links
// around the scan, FindLoopClosures finds places that the path came back to, and ReviseTraverse makes all of it one
// trajectory. Each is a function of the traverse so far; AppendScan and ApplyRevision change it. This header includes
// all of them.
#ifndef CURVEREG_CORE_MAPPING_TRACKING_H_
#define CURVEREG_CORE_MAPPING_TRACKING_H_

#include "core/mapping/find_links.h"
#include "core/mapping/revise_traverse.h"
#include "core/mapping/track_scan.h"
#include "core/mapping/traverse_changes.h"

#endif  // CURVEREG_CORE_MAPPING_TRACKING_H_
