// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/traverses/scan_stream.h"

#include <utility>

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr int kMostResults = 8;  // read at once

constexpr MethodTraits kTraits = {v1::TraverseService::service_full_name(), "StreamScans", Scope::kWrite};

}  // namespace

ScanStream::ScanStream(const Environment& environment, grpc::CallbackServerContext& context)
    : ChunkStream(environment.calls, kTraits, *environment.disk_pool, context),
      session_(environment.session, replaced(), [this] { Wake(); }) {
  Begin();
}

bool ScanStream::Parse(grpc::ByteBuffer& bytes, v1::StreamScansRequest& request) const {
  return grpc::SerializationTraits<v1::StreamScansRequest>::Deserialize(&bytes, &request).ok();
}

absl::StatusOr<std::optional<v1::StreamScansResponse>> ScanStream::Handle(v1::StreamScansRequest& request) {
  absl::StatusOr<std::optional<v1::StreamScansResponse>> answer = session_.Handle(request);
  // Results may be there already, of which nobody wakes us.
  if (answer.ok() && answer->has_value() && (*answer)->has_ready()) Wake();
  return answer;
}

absl::Status ScanStream::TakeNews(std::vector<v1::StreamScansResponse>& news) {
  absl::StatusOr<std::vector<v1::ScanResult>> results = session_.TakeResults(kMostResults);
  if (!results.ok()) return results.status();
  for (v1::ScanResult& result : *results) *news.emplace_back().mutable_result() = std::move(result);
  return absl::OkStatus();
}

bool ScanStream::Supersedes(const v1::StreamScansResponse& newer, const v1::StreamScansResponse& older) const {
  // Of one scan the latest offset is enough.
  return newer.has_ack() && older.has_ack() && !older.ack().complete() &&
         newer.ack().sequence_number() == older.ack().sequence_number();
}

std::optional<absl::Status> ScanStream::EndOfInput() const {
  if (!session_.has_started() || !session_.is_between_scans()) {
    return wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "the stream ended before the last byte of a scan");
  }
  if (!session_.took_all_results()) return std::nullopt;
  return absl::OkStatus();
}

}  // namespace curvereg::server
