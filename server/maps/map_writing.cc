// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/maps/map_writing.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stop_status.h"
#include "core/mapping/elevation_map.h"
#include "core/mapping/point_map.h"
#include "server/preparation/scan_sources.h"
#include "wire/error.h"
#include "wire/point_codec.h"

namespace curvereg::server {
namespace {

static_assert(std::endian::native == std::endian::little, "points are written as they lie in memory");
static_assert(sizeof(Eigen::Vector3f) == 12);

// An eighth of all, within these. More makes large maps quicker: fewer passes.
constexpr uint64_t kMinWorkBytes = uint64_t{1} << 20;
constexpr uint64_t kMaxWorkBytes = uint64_t{256} << 20;
// One scan's free space while it is made (dynamic_removal.h), and pieces on their way.
constexpr uint64_t kOtherBytes = uint64_t{8} << 20;

class StoredScans {
 public:
  StoredScans(const std::vector<std::string>& ids, const MapEnvironment& environment)
      : ids_(ids), environment_(environment) {}

  // Looks all of them up.
  absl::Status Find(const Stop& stop) {
    for (const std::string& id : ids_) {
      if (absl::Status status = StopStatus(stop, "the map"); !status.ok()) return status;
      absl::StatusOr<StoredScan> scan = environment_.store->GetScan(id);
      if (!scan.ok()) return scan.status();
      // It may have been stored when the limits were wider.
      absl::Status status = wire::ValidateHeader(scan->header, scan->payload_bytes, PointLimitsOf(environment_.limits));
      if (!status.ok()) return status;
      max_bytes_ = std::max(max_bytes_, scan->payload_bytes + wire::DecodingBytes(scan->header));
    }
    return absl::OkStatus();
  }

  // Of the largest, with what decoding takes.
  uint64_t max_bytes() const { return max_bytes_; }

  absl::StatusOr<std::shared_ptr<const Scan>> Load(std::size_t index) const {
    const absl::StatusOr<StoredScan> stored = environment_.store->GetScan(ids_[index]);
    if (!stored.ok()) return stored.status();
    const absl::StatusOr<std::string> payload = environment_.store->ReadWholePayload(ids_[index]);
    if (!payload.ok()) return payload.status();
    absl::StatusOr<Scan> scan = wire::DecodeScan(stored->header, *payload, PointLimitsOf(environment_.limits));
    if (!scan.ok()) return scan.status();
    return std::make_shared<const Scan>(*std::move(scan));
  }

 private:
  const std::vector<std::string>& ids_;
  const MapEnvironment& environment_;
  uint64_t max_bytes_ = 0;
};

absl::StatusOr<uint64_t> WritePoints(const MapInput& input, const PointMapOptions& options, const MapSink& sink,
                                     const Stop& stop) {
  uint64_t num_points = 0;
  const PointSink write = [&](std::span<const Eigen::Vector3f> points) {
    num_points += points.size();
    return sink({reinterpret_cast<const char*>(points.data()), points.size_bytes()});
  };
  absl::Status status = BuildPointMap(input, options, write, stop);
  if (!status.ok()) return status;
  return num_points;
}

absl::StatusOr<uint64_t> WriteElevation(const MapInput& input, const PointMapOptions& options, const MapSink& sink,
                                        const Stop& stop) {
  const absl::StatusOr<ElevationMap> map = BuildElevationMap(input, options, stop);
  if (!map.ok()) {
    if (!absl::IsResourceExhausted(map.status()) || wire::ReasonOf(map.status()).has_value()) return map.status();
    return wire::MakeError(v1::ERROR_REASON_SCAN_TOO_LARGE, std::string(map.status().message()),
                           {{"limit", std::to_string(options.max_memory_bytes)}});
  }
  absl::Status status = WriteEsriAscii(*map, sink);
  if (!status.ok()) return status;
  return map->heights.size();
}

}  // namespace

absl::StatusOr<uint64_t> WriteMap(const MapContents& contents, const MapSource& source,
                                  const MapEnvironment& environment, const MapSink& sink, const Stop& stop) {
  StoredScans scans(source.scan_ids, environment);
  absl::Status status = scans.Find(stop);
  if (!status.ok()) return status;
  const uint64_t work_bytes = std::clamp(environment.memory->total_bytes() / 8, kMinWorkBytes, kMaxWorkBytes);
  const absl::StatusOr<MemoryBudget::Reservation> memory =
      environment.memory->Reserve(work_bytes + scans.max_bytes() + kOtherBytes);
  if (!memory.ok()) return memory.status();
  const MapInput input{source.T_segment_scan, [&](std::size_t index, const Stop&) { return scans.Load(index); }};
  const PointMapOptions options{
      .cell_m = contents.cell_m, .remove_dynamic = contents.remove_seen_through, .max_memory_bytes = work_bytes};
  return contents.kind == v1::MAP_KIND_ELEVATION_ASCII ? WriteElevation(input, options, sink, stop)
                                                       : WritePoints(input, options, sink, stop);
}

}  // namespace curvereg::server
