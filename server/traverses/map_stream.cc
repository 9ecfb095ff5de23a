// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/map_stream.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/parallel.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

// Two seconds of a thin link (256 kbit/s): what a cut costs at most.
constexpr uint64_t kChunkBytes = 64 << 10;

// There is no such map to go on with; a new one begins at 0.
absl::Status GoneError(std::string_view message) {
  return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, message, {{"committed_offset", "0"}});
}

}  // namespace

const MethodTraits MapStream::kTraits = {v1::TraverseService::service_full_name(), "DownloadMap", Scope::kRead};

MapStream::MapStream(const Environment& environment, grpc::CallbackServerContext& context,
                     const v1::DownloadMapRequest& request)
    : ResponseStream(environment.calls, kTraits, context),
      environment_(environment),
      request_(request),
      map_request_{request.name(), request.segment(), request.kind(), request.cell_m(), request.remove_seen_through()} {
  Begin();
}

absl::StatusOr<MapStream::Next> MapStream::Make(std::deque<v1::DownloadMapResponse>& made) {
  if (map_ != nullptr) return ReadChunk(made);
  return source_.has_value() ? BuildMap(made) : FindMap(made);
}

absl::StatusOr<MapStream::Next> MapStream::FindMap(std::deque<v1::DownloadMapResponse>& made) {
  if (request_.offset() > 0 && !request_.has_version()) {
    return wire::FieldError("version", "is required with an offset above 0");
  }
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(request_.name());
  if (!traverse.ok()) return traverse.status();
  if (request_.has_version()) {  // a segment may have ended in the newest version
    std::shared_ptr<const MapFile> map = environment_.maps->FindBuilt(map_request_, request_.version());
    if (map != nullptr) return Announce(std::move(map), made);
  }
  absl::StatusOr<SegmentScans> scans = (*traverse)->ScansOfSegment(request_.segment());
  if (!scans.ok()) return scans.status();
  if (request_.has_version() && request_.version() != scans->version) {
    return GoneError(absl::StrCat("there is no map of that version any more; the newest is ", scans->version));
  }
  source_ = MapSource{scans->version, std::move(scans->scan_ids), std::move(scans->T_segment_scan)};
  return Next::kMore;
}

absl::StatusOr<MapStream::Next> MapStream::BuildMap(std::deque<v1::DownloadMapResponse>& made) {
  absl::StatusOr<std::shared_ptr<const MapFile>> map = absl::UnknownError("not built");
  WithThreadLimit(environment_.limits.max_threads_per_registration,
                  [&] { map = environment_.maps->Build(map_request_, *source_, call().stop()); });
  source_.reset();
  if (!map.ok()) return map.status();
  return Announce(*std::move(map), made);
}

absl::StatusOr<MapStream::Next> MapStream::Announce(std::shared_ptr<const MapFile> map,
                                                    std::deque<v1::DownloadMapResponse>& made) {
  const v1::MapHeader& header = map->header();
  if (request_.offset() > header.payload_bytes()) return GoneError("the offset lies beyond the end of the map");
  offset_ = request_.offset();
  *made.emplace_back().mutable_header() = header;
  map_ = std::move(map);
  return offset_ == header.payload_bytes() ? Next::kEnd : Next::kMore;
}

absl::StatusOr<MapStream::Next> MapStream::ReadChunk(std::deque<v1::DownloadMapResponse>& made) {
  absl::StatusOr<std::string> data =
      map_->Read(offset_, std::min<uint64_t>(kChunkBytes, environment_.limits.max_chunk_bytes));
  if (!data.ok()) return data.status();
  if (data->empty()) return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the map's file is shorter than it was");
  v1::PayloadChunk& chunk = *made.emplace_back().mutable_chunk();
  chunk.set_offset(offset_);
  chunk.set_crc32c(wire::Crc32c(*data));
  offset_ += data->size();
  chunk.set_data(*std::move(data));
  return offset_ < map_->header().payload_bytes() ? Next::kMore : Next::kEnd;
}

}  // namespace curvereg::server
