// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/dataset_text.h"

#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/text_fields.h"

namespace curvereg {
namespace {

constexpr std::size_t kMatrixColumns = 16;
constexpr double kRotationTolerance = 0.01;  // published truths have as few as six decimals

// The next line of data, split; nullopt after the last.
std::optional<std::vector<std::string_view>> NextRow(LineReader& lines) {
  while (std::optional<std::string_view> rest = lines.Next()) {
    std::vector<std::string_view> fields;
    for (std::string_view field = NextField(*rest); !field.empty(); field = NextField(*rest)) fields.push_back(field);
    if (!fields.empty() && fields[0][0] != '#') return fields;
  }
  return std::nullopt;
}

absl::Status LineError(const LineReader& lines, absl::string_view cause) {
  return absl::InvalidArgumentError(absl::StrCat("line ", lines.line_number(), ": ", cause));
}

absl::StatusOr<RigidTransform> ParseMatrix(std::span<const std::string_view> fields) {
  RigidTransform T = RigidTransform::Identity();
  for (std::size_t i = 0; i < kMatrixColumns; ++i) {
    const std::optional<double> value = ParseDouble(fields[i]);
    if (!value.has_value() || !std::isfinite(*value)) {
      return absl::InvalidArgumentError(absl::StrCat(Quoted(fields[i]), " is not a finite number"));
    }
    T.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = *value;
  }
  const bool has_last_row = (T.matrix().row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < 1e-9;
  if (!has_last_row || !IsRigid(T, kRotationTolerance)) {
    return absl::InvalidArgumentError("the last 16 numbers are not a rigid transform, row by row");
  }
  return Orthonormalised(T);
}

absl::StatusOr<ScanPair> ParsePair(const std::vector<std::string_view>& fields) {
  if (fields.size() < 2 + kMatrixColumns) {
    return absl::InvalidArgumentError(
        absl::StrCat("has ", fields.size(), " columns, needs two names and at least 16 numbers"));
  }
  ScanPair pair;
  pair.source = std::string(fields[0]);
  pair.target = std::string(fields[1]);
  if (fields.size() > 2 + kMatrixColumns) {
    const std::optional<double> overlap = ParseDouble(fields[2]);
    if (!overlap.has_value() || !(*overlap <= 1.0)) {
      return absl::InvalidArgumentError(absl::StrCat("overlap ", Quoted(fields[2]), " is not a number up to 1"));
    }
    pair.overlap = *overlap >= 0.0 ? *overlap : -1.0;
  }
  const absl::StatusOr<RigidTransform> T = ParseMatrix(std::span(fields).last(kMatrixColumns));
  if (!T.ok()) return T.status();
  pair.T_target_source = *T;
  return pair;
}

}  // namespace

absl::StatusOr<std::vector<PairLine>> ParsePairs(std::string_view text) {
  std::vector<PairLine> pairs;
  LineReader lines(text);
  while (const auto fields = NextRow(lines)) {
    absl::StatusOr<ScanPair> pair = ParsePair(*fields);
    if (!pair.ok()) return LineError(lines, pair.status().message());
    pairs.push_back({*std::move(pair), lines.line_number()});
  }
  return pairs;
}

bool HasNamedPoses(std::string_view text) {
  LineReader lines(text);
  const auto fields = NextRow(lines);
  return fields.has_value() && fields->size() == 1 + kMatrixColumns;
}

absl::StatusOr<std::vector<PoseLine>> ParseNamedPoses(std::string_view text) {
  std::vector<PoseLine> poses;
  LineReader lines(text);
  while (const auto fields = NextRow(lines)) {
    if (fields->size() != 1 + kMatrixColumns) {
      return LineError(lines, absl::StrCat("has ", fields->size(), " columns, needs a name and 16 numbers"));
    }
    const absl::StatusOr<RigidTransform> T = ParseMatrix(std::span(*fields).last(kMatrixColumns));
    if (!T.ok()) return LineError(lines, T.status().message());
    poses.push_back({std::string(fields->front()), *T, lines.line_number()});
  }
  return poses;
}

}  // namespace curvereg
