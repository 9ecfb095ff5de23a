// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/render_call.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/parallel.h"
#include "wire/error.h"
#include "wire/options_conversion.h"

namespace curvereg::server {
namespace {

constexpr std::array<std::pair<PictureKind, v1::PictureKind>, 4> kKinds = {
    {{PictureKind::kViews, v1::PICTURE_KIND_VIEWS},
     {PictureKind::kCoefficients, v1::PICTURE_KIND_COEFFICIENTS},
     {PictureKind::kDifferences, v1::PICTURE_KIND_DIFFERENCES},
     {PictureKind::kKeypoints, v1::PICTURE_KIND_KEYPOINTS}}};

v1::PictureKind ToWire(PictureKind kind) {
  const auto* const found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& pair) { return pair.first == kind; });
  return found == kKinds.end() ? v1::PICTURE_KIND_UNSPECIFIED : found->second;
}

absl::StatusOr<std::set<PictureKind>> KindsOf(const v1::RenderScanRequest& request) {
  std::set<PictureKind> kinds;
  for (const int wanted : request.kinds()) {
    const auto* const found =
        std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& pair) { return pair.second == wanted; });
    if (found == kKinds.end()) return wire::FieldError("kinds", "not a kind that this server knows");
    kinds.insert(found->first);
  }
  return kinds;
}

}  // namespace

const MethodTraits RenderCall::kTraits = {v1::RegistrationService::service_full_name(), "RenderScan", Scope::kRead};

RenderCall::RenderCall(const RegistrationBackend& backend, grpc::CallbackServerContext& context,
                       const v1::RenderScanRequest& request, v1::RenderScanResponse& response)
    : ComputingCall({backend.calls, *backend.scans.memory, *backend.pool}, kTraits, context),
      backend_(backend),
      request_(request),
      response_(response) {}

absl::StatusOr<uint64_t> RenderCall::Check() {
  absl::StatusOr<std::set<PictureKind>> kinds = KindsOf(request_);
  if (!kinds.ok()) return kinds.status();
  kinds_ = *std::move(kinds);
  absl::StatusOr<RegistrationInput> scan = RegistrationInput::Find(request_.scan(), "scan", backend().scans);
  if (!scan.ok()) return scan.status();
  scan_ = *std::move(scan);
  return scan_->DecodingBytes() + RenderingBytes(scan_->num_points());
}

absl::Status RenderCall::Compute(const Stop& stop) {
  const absl::StatusOr<std::shared_ptr<const Scan>> scan = scan_->Decode();
  if (!scan.ok()) return scan.status();
  if (absl::Status status = ValidateScan(**scan, {}, stop); !status.ok()) return scan_->Named(status);
  const int num_threads =
      wire::ThreadsWithin(request_.max_threads(), backend().scans.limits.max_threads_per_registration);
  absl::StatusOr<ScanPictures> pictures = absl::UnknownError("not drawn");
  WithThreadLimit(num_threads, [&] { pictures = DrawScan(**scan, kinds_, stop); });
  if (!pictures.ok()) return scan_->Named(pictures.status());
  return Answer(*pictures, stop);
}

absl::Status RenderCall::Answer(const ScanPictures& pictures, const Stop& stop) {
  for (const NamedPicture& named : pictures.pictures) {
    if (stop.Requested()) return absl::CancelledError("cancelled while pictures were encoded");
    absl::StatusOr<std::string> png = EncodePng(named.picture);
    if (!png.ok()) return png.status();
    v1::RenderedPicture& picture = *response_.add_pictures();
    picture.set_kind(ToWire(named.kind));
    picture.set_name(named.name);
    picture.set_png(*std::move(png));
  }
  response_.set_point_count(static_cast<uint64_t>(pictures.num_points));
  for (const auto& [view, count] : pictures.num_keypoints) {
    v1::KeypointCount& keypoints = *response_.add_keypoint_counts();
    keypoints.set_view(view);
    keypoints.set_count(static_cast<uint32_t>(count));
  }
  return absl::OkStatus();
}

}  // namespace curvereg::server
