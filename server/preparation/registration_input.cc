// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/preparation/registration_input.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"
#include "wire/point_codec.h"
#include "wire/resource_names.h"

namespace curvereg::server {

absl::StatusOr<RegistrationInput> RegistrationInput::Find(const v1::ScanInput& input, const std::string& field,
                                                          const ScanSources& sources) {
  if (input.has_name()) {
    const absl::StatusOr<std::string> id = wire::ScanIdOf(input.name(), absl::StrCat(field, ".name"));
    if (!id.ok()) return id.status();
    return OfStored(*id, field, sources);
  }
  if (!input.has_inline_scan()) return wire::FieldError(field, "give a name or an inline_scan");
  RegistrationInput found(field, sources);
  found.inline_scan_ = &input.inline_scan();
  if (absl::Status status = found.CheckInline(); !status.ok()) return status;
  return found;
}

absl::StatusOr<RegistrationInput> RegistrationInput::OfStored(const std::string& scan_id, const std::string& field,
                                                              const ScanSources& sources) {
  RegistrationInput found(field, sources);
  found.id_ = scan_id;
  if (absl::Status status = found.FindStored(); !status.ok()) return status;
  return found;
}

absl::Status RegistrationInput::FindStored() {
  if (sources_->store == nullptr) {
    return wire::MakeError(v1::ERROR_REASON_SCAN_NOT_FOUND, absl::StrCat(field_, ": this server stores no scans"));
  }
  cached_ = sources_->cache->Find(wire::ScanName(id_));
  if (cached_ != nullptr) return absl::OkStatus();
  absl::StatusOr<StoredScan> stored = sources_->store->GetScan(id_);
  if (!stored.ok()) return stored.status();
  payload_bytes_ = stored->payload_bytes;
  header_ = std::move(stored->header);
  // It may have been stored when the limits were wider.
  return wire::WithinField(absl::StrCat(field_, ".name"),
                           wire::ValidateHeader(header_, payload_bytes_, PointLimitsOf(sources_->limits)));
}

absl::Status RegistrationInput::CheckInline() const {
  return wire::WithinField(
      absl::StrCat(field_, ".inline_scan.header"),
      wire::ValidateHeader(inline_scan_->header(), inline_scan_->data().size(), PointLimitsOf(sources_->limits)));
}

const v1::PointCloudHeader& RegistrationInput::header() const { return is_stored() ? header_ : inline_scan_->header(); }

uint64_t RegistrationInput::num_points() const {
  return cached_ == nullptr ? header().point_count() : cached_->scan().points.size();
}

uint64_t RegistrationInput::DecodingBytes() const {
  return cached_ == nullptr ? payload_bytes_ + wire::DecodingBytes(header()) : 0;
}

absl::StatusOr<std::shared_ptr<const Scan>> RegistrationInput::Decode() const {
  // Of the prepared scan, which it keeps.
  if (cached_ != nullptr) return std::shared_ptr<const Scan>(cached_, &cached_->scan());
  const wire::PointLimits limits = PointLimitsOf(sources_->limits);
  absl::StatusOr<Scan> scan = Scan();
  if (is_stored()) {
    const absl::StatusOr<std::string> payload = sources_->store->ReadWholePayload(id_);
    if (!payload.ok()) return payload.status();
    scan = wire::DecodeScan(header_, *payload, limits);
  } else {
    scan = wire::DecodeScan(header(), inline_scan_->data(), limits);
    if (!scan.ok()) return wire::WithinField(absl::StrCat(field_, ".inline_scan.header"), scan.status());
    sources_->metrics->ScanReceived(header().point_count());
  }
  if (!scan.ok()) return scan.status();
  return std::make_shared<const Scan>(*std::move(scan));
}

absl::StatusOr<std::unique_ptr<const PreparedScan>> RegistrationInput::DecodeAndPrepare(const Stop& stop) const {
  absl::StatusOr<std::shared_ptr<const Scan>> scan = Decode();
  if (!scan.ok()) return scan.status();
  absl::StatusOr<std::unique_ptr<const PreparedScan>> prepared = PreparedScan::Create(*std::move(scan), {}, stop);
  if (!prepared.ok()) return Named(prepared.status());
  return prepared;
}

absl::StatusOr<std::shared_ptr<const PreparedScan>> RegistrationInput::Prepare(const Stop& stop) const {
  if (cached_ != nullptr) return cached_;
  if (!is_stored()) return DecodeAndPrepare(stop);
  return sources_->cache->Get(
      wire::ScanName(id_), [this](const Stop& loading_stop) { return DecodeAndPrepare(loading_stop); }, stop);
}

void RegistrationInput::UpdateCache() const {
  if (is_stored()) sources_->cache->UpdateSize(wire::ScanName(id_));
}

absl::Status RegistrationInput::Named(const absl::Status& status) const {
  if (!absl::IsInvalidArgument(status) || wire::ReasonOf(status).has_value()) return status;
  const std::string text(status.message());
  absl::Status named = wire::MakeError(v1::ERROR_REASON_UNUSABLE_SCAN, absl::StrCat(field_, ": ", text));
  wire::FieldError(field_, text).ForEachPayload([&](absl::string_view url, const absl::Cord& payload) {
    if (!named.GetPayload(url).has_value()) named.SetPayload(url, payload);  // the BadRequest
  });
  return named;
}

}  // namespace curvereg::server
