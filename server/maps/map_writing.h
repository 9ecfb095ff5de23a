// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The bytes of a map, made from stored scans, one of which is in memory at a time.
#ifndef CURVEREG_SERVER_MAPS_MAP_WRITING_H_
#define CURVEREG_SERVER_MAPS_MAP_WRITING_H_

#include <cstdint>
#include <functional>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/maps/map_source.h"

namespace curvereg::server {

struct MapContents {
  v1::MapKind kind = v1::MAP_KIND_POINTS;
  double cell_m = 0.1;
  bool remove_seen_through = false;
};

// Gives the bytes piece by piece and returns the number of points or grid cells. POINTS: packed little-endian float32
// x y z [m, segment frame]; ELEVATION_ASCII: an ESRI ASCII grid.
// Reserves what the largest scan and the cells in work take, before anything is read. Errors as MapBuilder::Build,
// those of `sink`.
using MapSink = std::function<absl::Status(std::string_view bytes)>;
absl::StatusOr<uint64_t> WriteMap(const MapContents& contents, const MapSource& source,
                                  const MapEnvironment& environment, const MapSink& sink, const Stop& stop);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_MAPS_MAP_WRITING_H_
