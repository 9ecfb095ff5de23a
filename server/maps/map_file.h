// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The file of a map: its payload, then its header, so that what was not finished or is damaged is told from what is
// whole. Errors as in server/store/store_file.h.
#ifndef CURVEREG_SERVER_MAPS_MAP_FILE_H_
#define CURVEREG_SERVER_MAPS_MAP_FILE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "server/maps/map_builder.h"
#include "server/store/store_file.h"
#include "wire/digest.h"

namespace curvereg::server {

// STORED_SCAN_DAMAGED: not a whole file of a map.
absl::StatusOr<std::shared_ptr<const MapFile>> OpenMapFile(const std::string& path);

// Writes a payload piece by piece. Used by one thread.
class MapFileWriter {
 public:
  // A file that is there is emptied. A payload of more than `max_bytes` is refused with STORAGE_FULL.
  static absl::StatusOr<MapFileWriter> Create(const std::string& path, uint64_t max_bytes);

  absl::Status Append(std::string_view bytes);
  // Forces all to disk. `header` needs no payload_bytes and payload_digest.
  absl::Status Finish(v1::MapHeader header);

 private:
  MapFileWriter(StoreFile file, uint64_t max_bytes, wire::Digester digester)
      : file_(std::move(file)), max_bytes_(max_bytes), digester_(std::move(digester)) {}
  absl::Status Flush();

  StoreFile file_;
  uint64_t max_bytes_;
  wire::Digester digester_;
  uint64_t written_bytes_ = 0;
  std::string pending_;  // small pieces are written together
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_MAPS_MAP_FILE_H_
