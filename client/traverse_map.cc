// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_map.h"

#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "client/retry.h"
#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::internal {
namespace {

constexpr std::size_t kPointBytes = sizeof(Eigen::Vector3f);

v1::DownloadMapRequest RequestOf(const std::string& name, const MapOptions& options) {
  v1::DownloadMapRequest request;
  request.set_name(name);
  request.set_kind(options.kind == MapOptions::Kind::kPoints ? v1::MAP_KIND_POINTS : v1::MAP_KIND_ELEVATION_ASCII);
  request.set_cell_m(options.cell_m);
  request.set_segment(static_cast<uint32_t>(options.segment));
  request.set_remove_seen_through(options.remove_dynamic);
  return request;
}

class MapDownload {
 public:
  MapDownload(Connection& connection, const std::string& name, const MapOptions& options)
      : connection_(connection),
        options_(options),
        retrier_(connection, {options.cancellation, connection.options().call_timeout, IsResumable}),
        request_(RequestOf(name, options)) {}

  absl::StatusOr<RemoteMap> Run() {
    const absl::Status status =
        retrier_.Run([this](const std::shared_ptr<grpc::Channel>& channel) { return RunStream(channel); });
    if (!status.ok()) return status;
    if (!wire::SameDigest(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, payload_), header_->payload_digest())) {
      return wire::MakeError(v1::ERROR_REASON_DIGEST_MISMATCH, "the downloaded map does not have its digest");
    }
    return Result();
  }

 private:
  absl::Status RunStream(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    connection_.Prepare(context);
    const std::stop_callback cancel(options_.cancellation, [&context] { context.TryCancel(); });
    request_.set_offset(payload_.size());
    if (header_) request_.set_version(header_->version());
    const auto reader = v1::TraverseService::NewStub(channel)->DownloadMap(&context, request_);
    has_header_ = false;
    absl::Status taken;
    for (v1::DownloadMapResponse response; taken.ok() && reader->Read(&response);) taken = Take(response);
    if (!taken.ok()) context.TryCancel();
    const grpc::Status status = reader->Finish();
    if (options_.cancellation.stop_requested()) return absl::CancelledError("cancelled by the caller");
    if (!taken.ok()) return taken;
    if (!status.ok()) return StartAnewIfGone(CallError(status, context));
    const bool complete = header_ && payload_.size() == header_->payload_bytes();
    return complete ? absl::OkStatus() : absl::UnavailableError("the server ended the map early");
  }

  // Scans have come or poses were revised since the first stream: what is here is of a map that is no more.
  absl::Status StartAnewIfGone(const absl::Status& error) {
    if (wire::ReasonOf(error) != v1::ERROR_REASON_OFFSET_OUT_OF_RANGE) return error;
    header_.reset();
    payload_.clear();
    request_.clear_version();
    return error;
  }

  absl::Status Take(const v1::DownloadMapResponse& response) {
    if (response.has_header() && !has_header_) return TakeHeader(response.header());
    if (response.has_chunk() && has_header_) return TakeChunk(response.chunk());
    return absl::InternalError("the server's answers to a download come in the wrong order");
  }

  absl::Status TakeHeader(const v1::MapHeader& header) {
    has_header_ = true;
    if (header_) {
      const bool same = header_->version() == header.version() && header_->payload_bytes() == header.payload_bytes() &&
                        wire::SameDigest(header_->payload_digest(), header.payload_digest());
      if (same) return absl::OkStatus();
      return StartAnewIfGone(
          wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, "the map changed while it was downloaded"));
    }
    const bool is_whole =
        options_.kind != MapOptions::Kind::kPoints ||
        (header.cell_count() == header.payload_bytes() / kPointBytes && header.payload_bytes() % kPointBytes == 0);
    if (!is_whole) return absl::InternalError("the server's map has another size than its points");
    header_ = header;
    return absl::OkStatus();
  }

  absl::Status TakeChunk(const v1::PayloadChunk& chunk) {
    const uint64_t left = header_->payload_bytes() - payload_.size();
    if (chunk.offset() != payload_.size() || chunk.data().size() > left) {
      return absl::InternalError("a chunk of a map lies in the wrong place");
    }
    if (!chunk.has_crc32c() || wire::Crc32c(chunk.data()) != chunk.crc32c()) {
      return wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "a chunk of a map came damaged");
    }
    payload_ += chunk.data();
    retrier_.NoteProgress();
    if (options_.progress) {
      options_.progress({payload_.size(), header_->payload_bytes(), 0, retrier_.num_attempts() - 1});
    }
    return absl::OkStatus();
  }

  RemoteMap Result() {
    static_assert(std::endian::native == std::endian::little && kPointBytes == 3 * sizeof(float));
    RemoteMap map;
    map.version = header_->version();
    map.num_cells = header_->cell_count();
    if (options_.kind == MapOptions::Kind::kPoints) {
      map.points.resize(payload_.size() / kPointBytes);
      if (!payload_.empty()) std::memcpy(static_cast<void*>(map.points.data()), payload_.data(), payload_.size());
    } else {
      map.text = std::move(payload_);
    }
    return map;
  }

  Connection& connection_;
  const MapOptions& options_;
  Retrier retrier_;
  v1::DownloadMapRequest request_;
  std::optional<v1::MapHeader> header_;  // the first stream's; later ones must agree
  std::string payload_;                  // checked bytes from the start
  bool has_header_ = false;              // in this stream
};

}  // namespace

absl::StatusOr<RemoteMap> DownloadMap(Connection& connection, const std::string& name, const MapOptions& options) {
  if (options.segment < 0) return absl::InvalidArgumentError("the number of a segment must not be below 0");
  return MapDownload(connection, name, options).Run();
}

}  // namespace curvereg::internal
