// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps of traverses as files: `<data_dir>/maps/`, each built once, written under a temporary name and renamed, reused
// for the same request over the same scans and poses, and removed, least recently used first, beyond a total size. What
// is there can always be made again. Safe to use from several threads.
#ifndef CURVEREG_SERVER_MAPS_MAP_BUILDER_H_
#define CURVEREG_SERVER_MAPS_MAP_BUILDER_H_

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "server/maps/map_source.h"

namespace curvereg::server {

// Which map.
struct MapRequest {
  std::string traverse;  // `traverses/{traverse}`
  uint32_t segment = 0;
  v1::MapKind kind = v1::MAP_KIND_UNSPECIFIED;  // unspecified: points
  double cell_m = 0.0;                          // 0: 0.1
  bool remove_seen_through = false;
};

// A map on disk, open: stays readable as long as this exists, whatever is removed meanwhile. Immutable.
class MapFile {
 public:
  virtual ~MapFile() = default;
  // Version, payload bytes, points or grid cells, XXH3_128.
  virtual const v1::MapHeader& header() const = 0;
  // `size` bytes of the payload from `offset`, fewer at the end. OFFSET_OUT_OF_RANGE: beyond the end; STORAGE_FAULT.
  virtual absl::StatusOr<std::string> Read(uint64_t offset, uint64_t size) const = 0;
};

class MapBuilder {
 public:
  struct Options {
    uint64_t max_stored_bytes = uint64_t{1} << 30;  // all maps together; a larger one is refused
  };
  // Creates the folder if need be and removes what an earlier process left unfinished. Errors: STORAGE_FULL,
  // STORAGE_FAULT.
  static absl::StatusOr<std::unique_ptr<MapBuilder>> Open(const std::string& data_dir,
                                                          const MapEnvironment& environment, const Options& options);
  static absl::StatusOr<std::unique_ptr<MapBuilder>> Open(const std::string& data_dir,
                                                          const MapEnvironment& environment) {
    return Open(data_dir, environment, Options());
  }
  virtual ~MapBuilder() = default;

  // The map if it is there already, else builds it on this thread, which takes seconds to minutes: call it from a
  // worker, under a thread limit. A second call for the same map waits for the first. INVALID_FIELD "cell_m" or "kind";
  // SCAN_NOT_FOUND and others of the store; MEMORY_BUDGET (try again), SCAN_TOO_LARGE (the grid or a scan needs more
  // memory than the server may use), STORAGE_FULL (the map is larger than all maps may be, or the disk is full),
  // STORAGE_FAULT, CANCELLED, DEADLINE_EXCEEDED. An empty source gives an empty map.
  virtual absl::StatusOr<std::shared_ptr<const MapFile>> Build(const MapRequest& request, const MapSource& source,
                                                               const Stop& stop) = 0;

  // The newest map that was built for the request over a trajectory of this version, null if none is left: to go on
  // with a download although scans have come since. Scans may come within a version: the digest tells whether it is
  // the same map.
  virtual std::shared_ptr<const MapFile> FindBuilt(const MapRequest& request, uint64_t version) = 0;

  // Removes all maps of a traverse: it was deleted.
  virtual void Forget(const std::string& traverse) = 0;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_MAPS_MAP_BUILDER_H_
