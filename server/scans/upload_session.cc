// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_session.h"

#include <string>
#include <string_view>
#include <utility>

#include "server/scans/scan_conversion.h"
#include "wire/cloud_header.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

absl::Status OrderError(std::string_view message) {
  return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, message);
}

absl::StatusOr<UploadDescription> Describe(v1::UploadScanStart& start, const LimitsConfig& limits) {
  UploadDescription description;
  absl::StatusOr<std::string> id = wire::UploadIdOf(start.upload(), "start.upload");
  if (!id.ok()) return id.status();
  description.id = *std::move(id);
  if (!start.has_header()) return wire::FieldError("start.header", "is missing");
  if (start.payload_bytes() == 0) return wire::FieldError("start.payload_bytes", "must be above 0");
  absl::Status valid =
      wire::ValidateHeader(start.header(), start.payload_bytes(), {limits.max_scan_points, limits.max_scan_bytes});
  if (!valid.ok()) return wire::WithinField("start.header", std::move(valid));
  description.header = std::move(*start.mutable_header());
  description.payload_bytes = start.payload_bytes();
  if (start.has_payload_digest()) {
    valid = wire::ValidateDigest(start.payload_digest());
    if (!valid.ok()) return wire::WithinField("start.payload_digest", std::move(valid));
    description.payload_digest = std::move(*start.mutable_payload_digest());
  }
  return description;
}

// The digest that the payload must have: declared by `start`, by `finish`, or by both alike.
absl::StatusOr<v1::Digest> DeclaredDigest(const std::optional<v1::Digest>& at_start,
                                          const v1::UploadScanFinish& finish) {
  if (!finish.has_payload_digest()) {
    if (at_start.has_value()) return *at_start;
    return wire::FieldError("finish.payload_digest", "is required unless start had one");
  }
  absl::Status valid = wire::ValidateDigest(finish.payload_digest());
  if (!valid.ok()) return wire::WithinField("finish.payload_digest", std::move(valid));
  if (at_start.has_value() && !wire::SameDigest(*at_start, finish.payload_digest())) {
    return wire::FieldError("finish.payload_digest", "differs from the one of start");
  }
  return finish.payload_digest();
}

}  // namespace

UploadSession::Answer UploadSession::Handle(UploadMessage& message) {
  v1::UploadScanRequest& request = message.request();
  if (request.has_start() == intake_.has_begun()) {
    return OrderError(intake_.has_begun() ? "start came a second time" : "the first message must be start");
  }
  switch (request.message_case()) {
    case v1::UploadScanRequest::kStart:
      return Start(*request.mutable_start());
    case v1::UploadScanRequest::kChunk:
      return Append(message);
    case v1::UploadScanRequest::kFinish:
      return Finish(request.finish());
    default:
      return OrderError("a message was empty, or of a kind that this server does not know");
  }
}

UploadSession::Answer UploadSession::Start(v1::UploadScanStart& start) {
  absl::StatusOr<UploadDescription> description = Describe(start, environment_.limits);
  if (!description.ok()) return description.status();
  const absl::StatusOr<std::optional<StoredScan>> known = intake_.Begin(*std::move(description));
  if (!known.ok()) return known.status();
  if (known->has_value()) return Done(**known, true);
  v1::UploadScanResponse response;
  response.mutable_ready()->set_committed_offset(intake_.committed_offset());
  response.mutable_ready()->set_max_chunk_bytes(environment_.limits.max_chunk_bytes);
  return response;
}

UploadSession::Answer UploadSession::Append(const UploadMessage& message) {
  const v1::PayloadChunk& chunk = message.request().chunk();
  ReceivedChunk received = {.offset = chunk.offset(), .pieces = message.chunk_data(), .crc32c = message.chunk_crc32c()};
  if (chunk.has_crc32c()) received.declared_crc32c = chunk.crc32c();
  if (absl::Status status = intake_.Append(received, ScanIntake::Overlap::kRefuse); !status.ok()) return status;
  v1::UploadScanResponse response;
  response.mutable_progress()->set_committed_offset(intake_.committed_offset());
  return response;
}

UploadSession::Answer UploadSession::Finish(const v1::UploadScanFinish& finish) {
  const absl::StatusOr<v1::Digest> declared = DeclaredDigest(intake_.description().payload_digest, finish);
  if (!declared.ok()) return declared.status();
  const absl::StatusOr<UploadWriter::Committed> committed = intake_.Finish(*declared);
  if (!committed.ok()) return committed.status();
  return Done(committed->scan, committed->already_stored);
}

v1::UploadScanResponse UploadSession::Done(const StoredScan& scan, bool already_stored) {
  is_done_ = true;
  v1::UploadScanResponse response;
  *response.mutable_done()->mutable_scan() = ToWire(scan);
  response.mutable_done()->set_already_stored(already_stored);
  return response;
}

std::optional<absl::Status> UploadSession::EndOfInput() const { return OrderError("the stream ended before finish"); }

}  // namespace curvereg::server
