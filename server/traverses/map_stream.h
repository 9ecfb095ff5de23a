// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One DownloadMap call: the map is found or built, then read piece by piece while the piece before is being written.
#ifndef CURVEREG_SERVER_TRAVERSES_MAP_STREAM_H_
#define CURVEREG_SERVER_TRAVERSES_MAP_STREAM_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "curvereg/v1/traverse_service.pb.h"
#include "server/maps/map_builder.h"
#include "server/rpc/call.h"
#include "server/rpc/response_stream.h"
#include "server/scheduling/worker_pool.h"
#include "server/settings/server_config.h"
#include "server/traverses/traverses.h"

namespace curvereg::server {

class MapStream final : public ResponseStream<v1::DownloadMapResponse> {
 public:
  static const MethodTraits kTraits;

  // Everything in it outlives the call.
  struct Environment {
    CallEnvironment calls;
    LimitsConfig limits;
    Traverses* traverses = nullptr;
    MapBuilder* maps = nullptr;
    WorkerPool* pool = nullptr;       // builds
    WorkerPool* disk_pool = nullptr;  // reads
  };
  // `request` is gRPC's, which keeps it until OnDone.
  MapStream(const Environment& environment, grpc::CallbackServerContext& context,
            const v1::DownloadMapRequest& request);

 private:
  ~MapStream() override = default;

  absl::StatusOr<Next> Make(std::deque<v1::DownloadMapResponse>& made) override;
  WorkerPool& pool() override { return source_.has_value() ? *environment_.pool : *environment_.disk_pool; }

  // In this order, one a task: FindMap; BuildMap unless it was found; ReadChunk until all is read.
  absl::StatusOr<Next> FindMap(std::deque<v1::DownloadMapResponse>& made);
  absl::StatusOr<Next> BuildMap(std::deque<v1::DownloadMapResponse>& made);
  absl::StatusOr<Next> ReadChunk(std::deque<v1::DownloadMapResponse>& made);
  absl::StatusOr<Next> Announce(std::shared_ptr<const MapFile> map, std::deque<v1::DownloadMapResponse>& made);

  const Environment& environment_;
  const v1::DownloadMapRequest& request_;
  const MapRequest map_request_;
  std::optional<MapSource> source_;  // the map is to be built from it
  std::shared_ptr<const MapFile> map_;
  uint64_t offset_ = 0;  // of the next chunk
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRAVERSES_MAP_STREAM_H_
