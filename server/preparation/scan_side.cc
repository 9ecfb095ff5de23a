// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/scan_side.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

wire::PointLimits LimitsOf(const RegistrationBackend& backend) {
  // An inline payload came within the limit on messages; the limit here is of the block that it decodes to, too.
  return {.max_points = backend.limits.max_scan_points,
          .max_payload_bytes = std::max(backend.limits.max_scan_bytes, backend.limits.max_message_bytes)};
}

}  // namespace

absl::StatusOr<ScanSide> ScanSide::Find(const v1::ScanInput& input, const std::string& field,
                                        const RegistrationBackend& backend) {
  ScanSide side;
  side.backend_ = &backend;
  side.input_ = &input;
  side.field_ = field;
  absl::Status status = wire::FieldError(field, "give a name or an inline_scan");
  if (input.has_name()) status = side.FindStored();
  if (input.has_inline_scan()) status = side.FindInline();
  if (!status.ok()) return status;
  return side;
}

absl::Status ScanSide::FindStored() {
  absl::StatusOr<std::string> id = wire::ScanIdOf(input_->name(), absl::StrCat(field_, ".name"));
  if (!id.ok()) return id.status();
  id_ = *std::move(id);
  if (backend_->store == nullptr) {
    return wire::MakeError(v1::ERROR_REASON_SCAN_NOT_FOUND, absl::StrCat(field_, ": this server stores no scans"));
  }
  cached_ = backend_->cache->Find(input_->name());
  if (cached_ != nullptr) return absl::OkStatus();
  absl::StatusOr<StoredScan> stored = backend_->store->GetScan(id_);
  if (!stored.ok()) return stored.status();
  payload_bytes_ = stored->payload_bytes;
  header_ = std::move(stored->header);
  // It may have come when the limits were wider.
  return wire::WithinField(absl::StrCat(field_, ".name"),
                           wire::ValidateHeader(header_, payload_bytes_, LimitsOf(*backend_)));
}

absl::Status ScanSide::FindInline() {
  const v1::PointCloud& cloud = input_->inline_scan();
  return wire::WithinField(absl::StrCat(field_, ".inline_scan.header"),
                           wire::ValidateHeader(cloud.header(), cloud.data().size(), LimitsOf(*backend_)));
}

const v1::PointCloudHeader& ScanSide::header() const { return is_stored() ? header_ : input_->inline_scan().header(); }

uint64_t ScanSide::num_points() const {
  return cached_ == nullptr ? header().point_count() : cached_->scan().points.size();
}

uint64_t ScanSide::DecodingBytes() const {
  return cached_ == nullptr ? payload_bytes_ + wire::DecodingBytes(header()) : 0;
}

absl::StatusOr<std::shared_ptr<const Scan>> ScanSide::Decode() const {
  // Of the prepared scan, which it keeps.
  if (cached_ != nullptr) return std::shared_ptr<const Scan>(cached_, &cached_->scan());
  absl::StatusOr<Scan> scan = Scan();
  if (is_stored()) {
    const absl::StatusOr<std::string> payload = backend_->store->ReadWholePayload(id_);
    if (!payload.ok()) return payload.status();
    scan = wire::DecodeScan(header_, *payload, LimitsOf(*backend_));
  } else {
    const v1::PointCloud& cloud = input_->inline_scan();
    scan = wire::DecodeScan(cloud.header(), cloud.data(), LimitsOf(*backend_));
    if (!scan.ok()) return wire::WithinField(absl::StrCat(field_, ".inline_scan.header"), scan.status());
    backend_->calls.metrics->ScanReceived(cloud.header().point_count());
  }
  if (!scan.ok()) return scan.status();
  return std::make_shared<const Scan>(*std::move(scan));
}

absl::StatusOr<std::unique_ptr<const PreparedScan>> ScanSide::DecodeAndPrepare(const Stop& stop) const {
  absl::StatusOr<std::shared_ptr<const Scan>> scan = Decode();
  if (!scan.ok()) return scan.status();
  absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared = PreparedScan::Create(*std::move(scan), {}, stop);
  if (!prepared.ok()) return Named(prepared.status());
  return prepared;
}

absl::StatusOr<std::shared_ptr<const PreparedScan>> ScanSide::Prepare(const Stop& stop) const {
  if (cached_ != nullptr) return cached_;
  if (!is_stored()) return DecodeAndPrepare(stop);
  return backend_->cache->Get(
      input_->name(), [this](const Stop& loading_stop) { return DecodeAndPrepare(loading_stop); }, stop);
}

void ScanSide::UpdateCache() const {
  if (is_stored()) backend_->cache->UpdateSize(input_->name());
}

absl::Status ScanSide::Named(const absl::Status& status) const {
  if (!absl::IsInvalidArgument(status) || wire::ReasonOf(status).has_value()) return status;
  const std::string text(status.message());
  absl::Status named = wire::MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, absl::StrCat(field_, ": ", text));
  wire::FieldError(field_, text).ForEachPayload([&](absl::string_view url, const absl::Cord& payload) {
    if (!named.GetPayload(url).has_value()) named.SetPayload(url, payload);  // the BadRequest
  });
  return named;
}

}  // namespace curvereg::server
