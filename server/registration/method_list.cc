// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/registration/method_list.h"

#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/methods/registration_names.h"
#include "core/register_scans.h"
#include "wire/options_conversion.h"

namespace curvereg::server {
namespace {

std::string DescriptionOf(Method method) {
  switch (method) {
    case Method::kCurvelet:
      return "Bird's-eye curvelet features, refinement and verification; escalates to costlier settings if confidence "
             "is low. Any sensor attitude and heading; terrain and buildings.";
    case Method::kPaper:
      return "The published pipeline, unchanged: range panoramas, motions of decimetres.";
    case Method::kFpfhSacIa:
      return "FPFH features with SAC-IA: the paper's first baseline.";
    case Method::kHarris3dFpfh:
      return "Harris-3D key points with FPFH features: the paper's second baseline.";
    case Method::kIcp:
      return "Refinement alone, starting from the prior if there is one, else from the identity; verified as any other "
             "pose.";
  }
  return "";
}

v1::MethodOption& Add(const std::string& name, const std::string& description, v1::MethodInfo& info) {
  v1::MethodOption& option = *info.add_options();
  option.set_name(name);
  option.set_description(description);
  return option;
}

void AddOptions(Method method, const LimitsConfig& limits, v1::MethodInfo& info) {
  const bool heeds_prior = method == Method::kCurvelet || method == Method::kIcp;
  if (heeds_prior) {
    Add("prior.t_target_source",
        method == Method::kIcp ? "Start of the refinement; absent: the identity."
                               : "Initial guess, tried as one more hypothesis.",
        info)
        .set_unit("m, unit quaternion");
    Add("prior.covariance",
        "Uncertainty of the guess: poses farther than five standard deviations from it are not considered.", info)
        .set_unit("rad^2, rad m, m^2");
  } else {
    v1::MethodOption& seed = Add("seed", "Seed of the random choices: the same seed gives the same result.", info);
    seed.set_default_value(absl::StrCat(RegistrationOptions().seed));
    seed.set_min_value(0.0);
    seed.set_max_value(static_cast<double>(std::numeric_limits<uint64_t>::max()));
  }
  if (method != Method::kFpfhSacIa && method != Method::kHarris3dFpfh) {
    v1::MethodOption& threads = Add(
        "max_threads", "Maximum number of threads; affects the time, never the result. 0: as many as allowed.", info);
    threads.set_default_value("0");
    threads.set_min_value(0.0);
    threads.set_max_value(limits.max_threads_per_registration);
  }
  v1::MethodOption& budget =
      Add("time_budget", "When it expires the best pose so far is returned, with the reason `deadline`.", info);
  budget.set_unit("s");
  budget.set_min_value(1e-9);
}

}  // namespace

v1::ListMethodsResponse DescribeMethods(const LimitsConfig& limits) {
  v1::ListMethodsResponse response;
  for (const Method method : AllMethods()) {
    v1::MethodInfo& info = *response.add_methods();
    info.set_method(wire::ToWire(method));
    info.set_name(std::string(MethodName(method)));
    info.set_description(DescriptionOf(method));
    info.set_available(IsAvailable(method));
    AddOptions(method, limits, info);
  }
  v1::ServerLimits& wire_limits = *response.mutable_limits();
  wire_limits.set_max_message_bytes(limits.max_message_bytes);
  wire_limits.set_max_scan_points(limits.max_scan_points);
  wire_limits.set_max_scan_bytes(limits.max_scan_bytes);
  wire_limits.set_max_chunk_bytes(limits.max_chunk_bytes);
  wire_limits.set_max_threads(static_cast<uint32_t>(limits.max_threads_per_registration));
  wire_limits.set_max_concurrent_registrations(static_cast<uint32_t>(limits.max_concurrent_registrations));
  wire_limits.set_max_queue_length(static_cast<uint32_t>(limits.max_queue_length));
  wire_limits.set_max_queue_per_client(static_cast<uint32_t>(limits.max_queue_per_client));
  wire_limits.set_memory_bytes(limits.memory_bytes);
  wire_limits.set_cache_bytes(limits.cache_bytes);
  wire_limits.set_max_streams_per_connection(static_cast<uint32_t>(limits.max_streams_per_connection));
  wire_limits.set_max_stored_bytes(limits.max_stored_bytes);
  wire_limits.set_max_uploads(static_cast<uint32_t>(limits.max_uploads));
  wire_limits.set_upload_lifetime_seconds(static_cast<uint64_t>(limits.upload_lifetime_seconds));
  wire_limits.set_max_traverses(static_cast<uint32_t>(limits.max_traverses));
  wire_limits.set_max_scans_per_traverse(static_cast<uint32_t>(limits.max_scans_per_traverse));
  response.set_build_id(BuildId());
  return response;
}

}  // namespace curvereg::server
