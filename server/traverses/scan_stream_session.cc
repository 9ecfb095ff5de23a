// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/scan_stream_session.h"

#include <grpcpp/impl/codegen/proto_utils.h>

#include <string_view>

#include "server/store/scan_identity.h"
#include "server/tracking/traverse_conversion.h"
#include "server/traverses/streamed_upload.h"
#include "wire/cloud_header.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

constexpr int kMaxResults = 8;  // read at once

absl::Status OrderError(std::string_view message) {
  return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, message);
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

bool ScanStreamSession::Parse(grpc::ByteBuffer& bytes, Request& request) {
  return grpc::SerializationTraits<Request>::Deserialize(&bytes, &request).ok();
}

ScanStreamSession::Answer ScanStreamSession::Handle(Request& request) {
  if (request.has_start() == has_started()) {
    return OrderError(has_started() ? "start came a second time" : "the first message must be start");
  }
  switch (request.message_case()) {
    case v1::StreamScansRequest::kStart:
      return Start(request.start());
    case v1::StreamScansRequest::kHeader:
      return Announce(*request.mutable_header());
    case v1::StreamScansRequest::kChunk:
      return Append(request.chunk());
    default:
      return OrderError("a message was empty, or of a kind that this server does not know");
  }
}

ScanStreamSession::Answer ScanStreamSession::Start(const v1::StreamScansStart& start) {
  if (const absl::Status named = wire::TraverseIdOf(start.traverse(), "start.traverse").status(); !named.ok())
    return named;
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(start.traverse());
  if (!traverse.ok()) return traverse.status();
  absl::StatusOr<StreamTicket> ticket = (*traverse)->BeginStream(stream_.replaced);
  if (!ticket.ok()) return ticket.status();
  if (start.has_last_result_sequence_number()) {
    const uint64_t last = start.last_result_sequence_number();
    if (last >= ticket->next_sequence_number + ticket->reorder_window) {
      return wire::FieldError("start.last_result_sequence_number", "is of a scan that was never acknowledged");
    }
    next_result_ = last + 1;
  }
  // Before the first look at results, so that none is missed.
  subscription_ = (*traverse)->Subscribe(stream_.wake);
  name_ = start.traverse();
  ticket_ = *std::move(ticket);
  next_sequence_number_ = ticket_->next_sequence_number;
  const absl::StatusOr<UploadState> partial =
      environment_.uploads.store->GetUpload(StreamedUploadId(ticket_->traverse_id, next_sequence_number_));
  if (!partial.ok() && wire::ReasonOf(partial.status()) != v1::ERROR_REASON_UPLOAD_NOT_FOUND) return partial.status();
  stream_.wake();  // results may be there already
  v1::StreamScansResponse response;
  v1::StreamScansReady& ready = *response.mutable_ready();
  ready.set_next_sequence_number(next_sequence_number_);
  ready.set_committed_offset(partial.ok() ? partial->committed_offset : 0);
  ready.set_fencing_number(ticket_->fencing_number);
  ready.set_max_chunk_bytes(environment_.uploads.limits.max_chunk_bytes);
  return response;
}

ScanStreamSession::Answer ScanStreamSession::Announce(v1::StreamedScanHeader& header) {
  if (!IsBetweenScans()) return OrderError("a header came before the last byte of the scan before");
  if (absl::Status valid = ValidateScanHeader(header, environment_.uploads.limits); !valid.ok()) {
    return wire::WithinField("header", std::move(valid));
  }
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  bool known = false;
  if (const absl::Status status = (*traverse)->CheckScan(*ticket_, header, &known); !status.ok()) return status;
  scan_ = AnnouncedScan{.header = std::move(header)};  // clang 14 takes no emplace()
  intake_.emplace(environment_.uploads, stream_.replaced);
  // The store knows payloads by XXH3_128 alone; with another digest the transfer is needed to identify the scan.
  const v1::Digest& digest = scan_->header.payload_digest();
  if (known && digest.algorithm() == v1::DIGEST_ALGORITHM_XXH3_128) {
    intake_->BeginStored(Describe());
    return AddToTraverse(ScanId(scan_->header.header(), digest));
  }
  return BeginUpload();
}

ScanStreamSession::Answer ScanStreamSession::BeginUpload() {
  absl::StatusOr<std::optional<StoredScan>> stored = intake_->Begin(Describe());
  if (wire::ReasonOf(stored.status()) == v1::ERROR_REASON_UPLOAD_DIFFERS) {
    // Never acknowledged as a scan, so the client may have thought better of it.
    const absl::Status forgotten =
        ForgetStreamedUpload(ticket_->traverse_id, scan_->header.sequence_number(), *environment_.uploads.store);
    if (!forgotten.ok()) return forgotten;
    stored = intake_->Begin(Describe());
  }
  if (!stored.ok()) return stored.status();
  return stored->has_value() ? AddToTraverse((*stored)->id) : Progress();
}

UploadDescription ScanStreamSession::Describe() const {
  const v1::StreamedScanHeader& header = scan_->header;
  return {.id = StreamedUploadId(ticket_->traverse_id, header.sequence_number()),
          .header = header.header(),
          .payload_bytes = header.payload_bytes(),
          .payload_digest = header.payload_digest()};
}

ScanStreamSession::Answer ScanStreamSession::Append(const v1::PayloadChunk& chunk) {
  if (!scan_.has_value()) return OrderError("a chunk came before a header");
  const std::string_view data = chunk.data();
  ReceivedChunk received = {.offset = chunk.offset(), .crc32c = wire::Crc32c(data)};
  if (!data.empty()) received.pieces = {&data, 1};
  if (chunk.has_crc32c()) received.declared_crc32c = chunk.crc32c();
  const uint64_t committed_before = intake_->committed_offset();
  if (absl::Status status = intake_->Append(received, ScanIntake::Overlap::kSkip); !status.ok()) return status;
  if (intake_->committed_offset() == committed_before) return std::nullopt;
  return Progress();
}

// The acknowledgement of what is there, or, when that is all, of the scan.
ScanStreamSession::Answer ScanStreamSession::Progress() {
  if (!intake_->is_complete()) return Ack();
  const absl::StatusOr<UploadWriter::Committed> committed = intake_->Finish(scan_->header.payload_digest());
  if (!committed.ok()) return committed.status();
  return AddToTraverse(committed->scan.id);
}

ScanStreamSession::Answer ScanStreamSession::AddToTraverse(const std::string& scan_id) {
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  const absl::StatusOr<uint64_t> next = (*traverse)->AddScan(*ticket_, scan_->header, scan_id);
  if (!next.ok()) return next.status();
  next_sequence_number_ = *next;
  scan_->is_complete = true;
  Response response = Ack();
  response.mutable_ack()->set_complete(true);
  response.mutable_ack()->set_scan(wire::ScanName(scan_id));
  return response;
}

v1::StreamScansResponse ScanStreamSession::Ack() const {
  v1::StreamScansResponse response;
  response.mutable_ack()->set_sequence_number(scan_->header.sequence_number());
  response.mutable_ack()->set_committed_offset(intake_->committed_offset());
  return response;
}

absl::Status ScanStreamSession::TakeNotifications(std::vector<Response>& notifications) {
  absl::StatusOr<std::vector<v1::ScanResult>> results = TakeResults(kMaxResults);
  if (!results.ok()) return results.status();
  for (v1::ScanResult& result : *results) *notifications.emplace_back().mutable_result() = std::move(result);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<v1::ScanResult>> ScanStreamSession::TakeResults(int max_results) {
  const absl::StatusOr<std::shared_ptr<TrackedTraverse>> traverse = environment_.traverses->Find(name_);
  if (!traverse.ok()) return traverse.status();
  absl::StatusOr<std::vector<v1::ScanResult>> results = (*traverse)->Results(next_result_, max_results);
  if (results.ok() && !results->empty()) next_result_ = results->back().sequence_number() + 1;
  return results;
}

bool ScanStreamSession::Supersedes(const Response& newer, const Response& older) {
  // Of one scan the latest offset is enough.
  return newer.has_ack() && older.has_ack() && !older.ack().complete() &&
         newer.ack().sequence_number() == older.ack().sequence_number();
}

std::optional<absl::Status> ScanStreamSession::EndOfInput() const {
  if (!has_started() || !IsBetweenScans()) return OrderError("the stream ended before the last byte of a scan");
  if (!took_all_results()) return std::nullopt;
  return absl::OkStatus();
}

}  // namespace curvereg::server
