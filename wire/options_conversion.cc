// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/options_conversion.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "wire/duration.h"
#include "wire/error.h"
#include "wire/geometry_conversion.h"

namespace curvereg::wire {
namespace {

constexpr std::array<std::pair<Method, v1::Method>, 5> kMethods = {{{Method::kCurvelet, v1::METHOD_CURVELET},
                                                                    {Method::kPaper, v1::METHOD_PAPER},
                                                                    {Method::kFpfhSacIa, v1::METHOD_FPFH_SAC_IA},
                                                                    {Method::kHarris3dFpfh, v1::METHOD_HARRIS3D_FPFH},
                                                                    {Method::kIcp, v1::METHOD_ICP}}};

absl::StatusOr<Prior> PriorFromWire(const v1::Prior& message) {
  if (!message.has_t_target_source()) return FieldError("t_target_source", "missing");
  Prior prior;
  absl::StatusOr<RigidTransform> T_target_source = FromWire(message.t_target_source());
  if (!T_target_source.ok()) return WithinField("t_target_source", T_target_source.status());
  prior.T_target_source = *T_target_source;
  if (!message.has_covariance()) return prior;
  absl::StatusOr<Matrix6d> covariance = FromWire(message.covariance());
  if (!covariance.ok()) return WithinField("covariance", covariance.status());
  prior.covariance = *covariance;
  return prior;
}

}  // namespace

int ThreadsWithin(uint32_t wanted, int max_threads) {
  const uint32_t bound = static_cast<uint32_t>(max_threads > 0 ? max_threads : std::numeric_limits<int>::max());
  if (wanted == 0) return std::max(max_threads, 0);
  return static_cast<int>(std::min(wanted, bound));
}

v1::Method ToWire(Method method) {
  for (const auto& [ours, theirs] : kMethods) {
    if (ours == method) return theirs;
  }
  return v1::METHOD_UNSPECIFIED;
}

absl::StatusOr<Method> FromWire(v1::Method method) {
  if (method == v1::METHOD_UNSPECIFIED) return Method::kCurvelet;
  for (const auto& [ours, theirs] : kMethods) {
    if (theirs == method) return ours;
  }
  return FieldError("method", "not a method that this server knows");
}

v1::RegistrationOptions ToWire(const RegistrationOptions& options) {
  v1::RegistrationOptions message;
  message.set_method(ToWire(options.method));
  if (options.prior.has_value()) {
    *message.mutable_prior()->mutable_t_target_source() = ToWire(options.prior->T_target_source);
    if (options.prior->covariance.has_value()) {
      *message.mutable_prior()->mutable_covariance() = ToWire(*options.prior->covariance);
    }
  }
  message.set_seed(options.seed);
  message.set_max_threads(static_cast<uint32_t>(std::max(options.num_threads, 0)));
  if (options.time_budget_s.has_value()) {
    const double seconds = *options.time_budget_s;
    *message.mutable_time_budget() = ToWire(seconds > 0.0 ? std::max(seconds, 1e-9) : seconds);  // 0 would be refused
  }
  return message;
}

absl::StatusOr<RegistrationOptions> FromWire(const v1::RegistrationOptions& options, int max_threads) {
  RegistrationOptions result;
  const absl::StatusOr<Method> method = FromWire(options.method());
  if (!method.ok()) return method.status();
  result.method = *method;
  if (options.has_prior()) {
    absl::StatusOr<Prior> prior = PriorFromWire(options.prior());
    if (!prior.ok()) return WithinField("prior", prior.status());
    result.prior = *std::move(prior);
  }
  if (options.has_seed()) result.seed = options.seed();
  result.num_threads = ThreadsWithin(options.max_threads(), max_threads);
  if (options.has_time_budget()) {
    const std::optional<double> seconds = SecondsOf(options.time_budget());
    if (!seconds.has_value()) {
      return FieldError("time_budget", "not a duration: above 10,000 years, nanos of a second or more, or mixed signs");
    }
    if (!(*seconds > 0.0)) return FieldError("time_budget", "not above 0");
    result.time_budget_s = *seconds;
  }
  return result;
}

}  // namespace curvereg::wire
