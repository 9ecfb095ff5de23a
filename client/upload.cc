// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/upload.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/remote_scan.h"
#include "client/retry.h"
#include "client/upload_stream.h"
#include "wire/digest.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::internal {
namespace {

// A name that nobody else has chosen: a UUID of version 4.
std::string RandomUploadName() {
  std::random_device device;
  const auto draw = [&device](int num_bits) { return device() >> (32 - num_bits); };
  return wire::UploadName(absl::StrFormat("%08x-%04x-4%03x-%04x-%04x%08x", draw(32), draw(16), draw(12),
                                          0x8000U | draw(14), draw(16), draw(32)));
}

// The same for the same scan, so that a call goes on from where an earlier one stopped that came to nothing, in
// whatever process that was. Needs no more: other bytes under the name would not have the digest.
std::string UploadNameOf(const v1::UploadScanStart& start) {
  const v1::Digest digest = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, start.SerializeAsString());
  return wire::UploadName(wire::HexText(digest.value()));
}

absl::Status ValidateTransferOptions(const TransferOptions& options) {
  if (options.chunk_bytes == 0) return absl::InvalidArgumentError("chunk_bytes must be above 0");
  if (!(options.max_resend_share > 0.0 && options.max_resend_share <= 1.0)) {
    return absl::InvalidArgumentError("max_resend_share must be above 0 and at most 1");
  }
  return absl::OkStatus();
}

// Header and payload. Raw points lie in memory as they lie in the payload, so they are sent from where they are.
absl::StatusOr<UploadSource> SourceOf(const curvereg::Scan& scan, const TransferEncoding& encoding) {
  static_assert(std::endian::native == std::endian::little && sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  const bool is_raw = encoding.kind == TransferEncoding::Kind::kRaw;
  absl::StatusOr<v1::PointCloud> cloud = is_raw ? EncodeFor(encoding, {{}, scan.gravity}) : EncodeFor(encoding, scan);
  if (!cloud.ok()) return cloud.status();
  UploadSource source;
  *source.start.mutable_header() = cloud->header();
  if (is_raw) {
    source.start.mutable_header()->set_point_count(scan.points.size());
    source.payload.bytes = {reinterpret_cast<const char*>(scan.points.data()),
                            scan.points.size() * sizeof(Eigen::Vector3f)};
  } else {
    source.payload.owner = std::shared_ptr<const std::string>(cloud->release_data());
    source.payload.bytes = *source.payload.owner;
  }
  return source;
}

TransferProgress ProgressOf(const UploadState& state, const UploadSource& source, int num_resumes) {
  return {state.committed, source.payload.bytes.size(), state.bytes_resent, num_resumes};
}

class Upload {
 public:
  Upload(Connection& connection, UploadSource source, const TransferOptions& options)
      : connection_(connection),
        source_(std::move(source)),
        options_(options),
        retrier_(connection, {options.cancellation, connection.options().call_timeout, IsResumable}),
        share_base_(source_.payload.bytes.size()) {}

  absl::StatusOr<UploadOutcome> Run() {
    absl::Status status = RunStreams();
    if (NeedsOwnName(status)) {
      StartAnew();
      status = RunStreams();
    }
    if (!status.ok()) return status;
    return UploadOutcome{FromWire(state_.done->scan()), state_.done->already_stored(),
                         ProgressOf(state_, source_, num_resumes())};
  }

 private:
  int num_resumes() const { return retrier_.num_attempts() - 1; }

  absl::Status RunStreams() {
    return retrier_.Run([this](const std::shared_ptr<grpc::Channel>& channel) { return RunStream(channel); });
  }

  // Somebody else uploads the same and is not to be fought, or what somebody else left under the name is wrong.
  bool NeedsOwnName(const absl::Status& error) const {
    const std::optional<v1::ErrorReason> reason = wire::ReasonOf(error);
    return reason == v1::ERROR_REASON_WRITER_REPLACED || reason == v1::ERROR_REASON_UPLOAD_DIFFERS ||
           (reason == v1::ERROR_REASON_DIGEST_MISMATCH && state_.has_others_bytes);
  }

  void StartAnew() {
    source_.start.set_upload(RandomUploadName());
    state_.committed = 0;
    state_.has_others_bytes = false;
    most_committed_ = 0;
    share_base_ = source_.payload.bytes.size();
    retrier_.NoteProgress();
  }

  absl::Status RunStream(const std::shared_ptr<grpc::Channel>& channel) {
    const ClientOptions& settings = connection_.options();
    const UploadStream::Limits limits{.silence = settings.keepalive_interval + settings.keepalive_timeout,
                                      .finish_silence = settings.call_timeout,
                                      .cancellation = options_.cancellation};
    UploadStream stream(source_, state_, {share_base_, options_.max_resend_share, options_.chunk_bytes});
    const uint64_t before = state_.committed;
    const absl::Status status =
        stream.Run(connection_, channel, limits, [&](const UploadState& state) { Tell(state); });
    state_ = stream.state();
    // A link that is cut often may lose less at a time.
    share_base_ = std::min(share_base_, state_.committed - std::min(before, state_.committed));
    return status;
  }

  void Tell(const UploadState& state) {
    if (state.committed > most_committed_) retrier_.NoteProgress();
    most_committed_ = std::max(most_committed_, state.committed);
    if (options_.progress) options_.progress(ProgressOf(state, source_, num_resumes()));
  }

  Connection& connection_;
  UploadSource source_;
  const TransferOptions& options_;
  Retrier retrier_;
  UploadState state_;
  uint64_t share_base_;
  uint64_t most_committed_ = 0;
};

}  // namespace

absl::StatusOr<UploadOutcome> UploadScan(Connection& connection, const curvereg::Scan& scan,
                                         const TransferOptions& options) {
  if (absl::Status status = ValidateTransferOptions(options); !status.ok()) return status;
  absl::StatusOr<UploadSource> encoded = SourceOf(scan, options.encoding);
  if (!encoded.ok()) return encoded.status();
  BorrowedSlices borrowed;  // its destructor waits until gRPC has released the caller's bytes
  UploadSource source = *std::move(encoded);
  if (source.payload.owner == nullptr) source.payload.borrowed = &borrowed;
  source.start.mutable_header()->set_frame_id(options.frame_id);
  source.start.set_payload_bytes(source.payload.bytes.size());
  *source.start.mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, source.payload.bytes);
  source.start.set_upload(UploadNameOf(source.start));
  return Upload(connection, std::move(source), options).Run();
}

}  // namespace curvereg::internal
