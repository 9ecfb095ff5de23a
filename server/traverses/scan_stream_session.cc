// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/scan_stream_session.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/scans/scan_conversion.h"
#include "server/store/scan_identity.h"
#include "server/tracking/traverse_conversion.h"
#include "server/traverses/streamed_upload.h"
#include "wire/cloud_header.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

absl::Status OrderError(std::string_view message) {
  return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, message);
}

absl::Status OffsetError(std::string_view message, uint64_t committed_offset) {
  return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, message,
                         {{"committed_offset", absl::StrCat(committed_offset)}});
}

absl::Status ValidateScanHeader(const v1::StreamedScanHeader& header, const LimitsConfig& limits) {
  if (!header.has_header()) return wire::FieldError("header", "is missing");
  if (header.payload_bytes() == 0) return wire::FieldError("payload_bytes", "must be above 0");
  absl::Status valid =
      wire::ValidateHeader(header.header(), header.payload_bytes(), {limits.max_scan_points, limits.max_scan_bytes});
  if (!valid.ok()) return wire::WithinField("header", std::move(valid));
  if (!header.has_payload_digest()) return wire::FieldError("payload_digest", "is missing");
  valid = wire::ValidateDigest(header.payload_digest());
  if (!valid.ok()) return wire::WithinField("payload_digest", std::move(valid));
  return PriorOf(header).status();
}

}  // namespace

ScanStreamSession::Answer ScanStreamSession::Handle(v1::StreamScansRequest& request) {
  if (request.has_start() == has_started()) {
    return OrderError(has_started() ? "start came a second time" : "the first message must be start");
  }
  switch (request.message_case()) {
    case v1::StreamScansRequest::kStart:
      return Start(request.start());
    case v1::StreamScansRequest::kHeader:
      return Announce(*request.mutable_header());
    case v1::StreamScansRequest::kChunk:
      return Append(*request.mutable_chunk());
    default:
      return OrderError("a message was empty, or of a kind that this server does not know");
  }
}

ScanStreamSession::Answer ScanStreamSession::Start(const v1::StreamScansStart& start) {
  if (const absl::Status named = TraverseIdOf(start.traverse(), "start.traverse").status(); !named.ok()) return named;
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(start.traverse());
  if (!traverse.ok()) return traverse.status();
  absl::StatusOr<StreamTicket> ticket = (*traverse)->BeginStream(replaced_);
  if (!ticket.ok()) return ticket.status();
  if (start.has_last_result_sequence_number()) {
    const uint64_t last = start.last_result_sequence_number();
    if (last >= ticket->next_sequence_number + ticket->reorder_window) {
      return wire::FieldError("start.last_result_sequence_number", "is of a scan that was never acknowledged");
    }
    next_result_ = last + 1;
  }
  // Before the first look at results, so that none is missed.
  subscription_ = (*traverse)->Subscribe(wake_);
  name_ = start.traverse();
  ticket_ = *std::move(ticket);
  next_sequence_number_ = ticket_->next_sequence_number;
  const absl::StatusOr<UploadState> partial =
      environment_.uploads.store->GetUpload(StreamedUploadId(ticket_->traverse_id, next_sequence_number_));
  if (!partial.ok() && wire::ReasonOf(partial.status()) != v1::ERROR_REASON_UPLOAD_NOT_FOUND) return partial.status();
  v1::StreamScansResponse response;
  v1::StreamScansReady& ready = *response.mutable_ready();
  ready.set_next_sequence_number(next_sequence_number_);
  ready.set_committed_offset(partial.ok() ? partial->committed_offset : 0);
  ready.set_fencing_number(ticket_->fencing_number);
  ready.set_max_chunk_bytes(environment_.uploads.limits.max_chunk_bytes);
  return response;
}

ScanStreamSession::Answer ScanStreamSession::Announce(v1::StreamedScanHeader& header) {
  if (!is_between_scans()) return OrderError("a header came before the last byte of the scan before");
  if (absl::Status valid = ValidateScanHeader(header, environment_.uploads.limits); !valid.ok()) {
    return wire::WithinField("header", std::move(valid));
  }
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  bool known = false;
  if (const absl::Status status = (*traverse)->CheckScan(*ticket_, header, &known); !status.ok()) return status;
  scan_ = StreamedScan{.header = std::move(header)};  // clang 14 takes no emplace()
  // The store knows payloads by XXH3_128 alone; with another digest the transfer tells which scan it is.
  const v1::Digest& digest = scan_->header.payload_digest();
  if (known && digest.algorithm() == v1::DIGEST_ALGORITHM_XXH3_128) {
    return AddToTraverse(ScanName(ScanId(scan_->header.header(), digest)));
  }
  return BeginUpload();
}

ScanStreamSession::Answer ScanStreamSession::BeginUpload() {
  absl::StatusOr<v1::UploadScanResponse> begun = StartUpload();
  if (wire::ReasonOf(begun.status()) == v1::ERROR_REASON_UPLOAD_DIFFERS) {
    // Never acknowledged as a scan, so the client may have thought better of it.
    const absl::Status forgotten =
        ForgetStreamedUpload(ticket_->traverse_id, scan_->header.sequence_number(), *environment_.uploads.store);
    if (!forgotten.ok()) return forgotten;
    begun = StartUpload();
  }
  if (!begun.ok()) return begun.status();
  if (begun->has_done()) return AddToTraverse(begun->done().scan().name());
  scan_->committed_offset = begun->ready().committed_offset();
  return scan_->committed_offset == scan_->header.payload_bytes() ? Finish() : Ack();
}

absl::StatusOr<v1::UploadScanResponse> ScanStreamSession::StartUpload() {
  upload_ = std::make_unique<UploadSession>(environment_.uploads, replaced_);
  v1::UploadScanRequest request;
  v1::UploadScanStart& start = *request.mutable_start();
  start.set_upload(UploadName(StreamedUploadId(ticket_->traverse_id, scan_->header.sequence_number())));
  *start.mutable_header() = scan_->header.header();
  start.set_payload_bytes(scan_->header.payload_bytes());
  *start.mutable_payload_digest() = scan_->header.payload_digest();
  return Upload(std::move(request));
}

ScanStreamSession::Answer ScanStreamSession::Append(v1::PayloadChunk& chunk) {
  if (!scan_.has_value()) return OrderError("a chunk came before a header");
  if (const absl::Status status = CheckChunk(chunk); !status.ok()) return status;
  const uint64_t num_known = scan_->committed_offset - chunk.offset();
  // What is new the upload checks.
  if (num_known > 0 && chunk.crc32c() != wire::Crc32c(chunk.data())) {
    environment_.uploads.metrics->ChecksumFailed();
    return wire::MakeError(v1::ERROR_REASON_CHECKSUM_MISMATCH, "a chunk does not have the CRC-32C that came with it");
  }
  if (num_known >= chunk.data().size()) return std::nullopt;
  v1::UploadScanRequest request;
  *request.mutable_chunk() = std::move(chunk);
  if (num_known > 0) {
    v1::PayloadChunk& rest = *request.mutable_chunk();
    rest.mutable_data()->erase(0, num_known);
    rest.set_offset(scan_->committed_offset);
    rest.set_crc32c(wire::Crc32c(rest.data()));
  }
  const absl::StatusOr<v1::UploadScanResponse> progress = Upload(std::move(request));
  if (!progress.ok()) return progress.status();
  scan_->committed_offset = progress->progress().committed_offset();
  return scan_->committed_offset == scan_->header.payload_bytes() ? Finish() : Ack();
}

absl::Status ScanStreamSession::CheckChunk(const v1::PayloadChunk& chunk) const {
  const uint32_t max_bytes = environment_.uploads.limits.max_chunk_bytes;
  if (chunk.data().empty() || chunk.data().size() > max_bytes) {
    return wire::FieldError("chunk.data", absl::StrCat("must have 1 to ", max_bytes, " bytes"));
  }
  if (!chunk.has_crc32c()) return wire::FieldError("chunk.crc32c", "is required");
  if (chunk.offset() > scan_->committed_offset) {
    return OffsetError("a chunk begins beyond the committed offset", scan_->committed_offset);
  }
  if (chunk.data().size() > scan_->header.payload_bytes() - chunk.offset()) {
    return OffsetError("a chunk goes beyond the declared size", scan_->committed_offset);
  }
  return absl::OkStatus();
}

ScanStreamSession::Answer ScanStreamSession::Finish() {
  v1::UploadScanRequest request;
  request.mutable_finish();
  const absl::StatusOr<v1::UploadScanResponse> done = Upload(std::move(request));
  if (!done.ok()) return done.status();
  return AddToTraverse(done->done().scan().name());
}

ScanStreamSession::Answer ScanStreamSession::AddToTraverse(const std::string& scan_name) {
  absl::StatusOr<std::string> scan_id = ScanIdOf(scan_name, "name");
  if (!scan_id.ok()) return scan_id.status();
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  const absl::StatusOr<uint64_t> next = (*traverse)->AddScan(*ticket_, scan_->header, *scan_id);
  if (!next.ok()) return next.status();
  next_sequence_number_ = *next;
  return Complete(*scan_id);
}

v1::StreamScansResponse ScanStreamSession::Complete(const std::string& scan_id) {
  upload_.reset();
  scan_->is_complete = true;
  scan_->committed_offset = scan_->header.payload_bytes();
  v1::StreamScansResponse response = Ack();
  response.mutable_ack()->set_complete(true);
  response.mutable_ack()->set_scan(ScanName(scan_id));
  return response;
}

v1::StreamScansResponse ScanStreamSession::Ack() const {
  v1::StreamScansResponse response;
  response.mutable_ack()->set_sequence_number(scan_->header.sequence_number());
  response.mutable_ack()->set_committed_offset(scan_->committed_offset);
  return response;
}

absl::StatusOr<v1::UploadScanResponse> ScanStreamSession::Upload(v1::UploadScanRequest request) {
  UploadMessage message(std::move(request));
  return upload_->Handle(message);
}

absl::StatusOr<std::vector<v1::ScanResult>> ScanStreamSession::TakeResults(int max_results) {
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  absl::StatusOr<std::vector<v1::ScanResult>> results = (*traverse)->Results(next_result_, max_results);
  if (results.ok() && !results->empty()) next_result_ = results->back().sequence_number() + 1;
  return results;
}

}  // namespace curvereg::server
