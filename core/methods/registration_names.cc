// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/methods/registration_names.h"

#include <array>

namespace curvereg {
namespace {

constexpr std::array kMethods = {Method::kCurvelet, Method::kPaper, Method::kFpfhSacIa, Method::kHarris3dFpfh,
                                 Method::kIcp};

}  // namespace

std::span<const Method> AllMethods() { return kMethods; }

std::string_view MethodName(Method method) {
  // A switch without a default, so that the compiler names an enumerator that was forgotten here.
  switch (method) {
    case Method::kCurvelet:
      return "curvelet";
    case Method::kPaper:
      return "paper";
    case Method::kFpfhSacIa:
      return "fpfh-sac-ia";
    case Method::kHarris3dFpfh:
      return "harris3d-fpfh";
    case Method::kIcp:
      return "icp";
  }
  return "unknown";
}

std::optional<Method> MethodFromName(std::string_view name) {
  for (const Method method : kMethods) {
    if (MethodName(method) == name) return method;
  }
  return std::nullopt;
}

std::string_view ReasonName(Reason reason) {
  switch (reason) {
    case Reason::kNotRun:
      return "not_run";
    case Reason::kTooFewPoints:
      return "too_few_points";
    case Reason::kTooFewFeatures:
      return "too_few_features";
    case Reason::kNoConsensus:
      return "no_consensus";
    case Reason::kResidualTooHigh:
      return "residual_too_high";
    case Reason::kOverlapTooLow:
      return "overlap_too_low";
    case Reason::kFreeSpaceViolated:
      return "free_space_violated";
    case Reason::kAmbiguous:
      return "ambiguous";
    case Reason::kDegenerateDirection:
      return "degenerate_direction";
    case Reason::kDeadline:
      return "deadline";
  }
  return "unknown";
}

}  // namespace curvereg
