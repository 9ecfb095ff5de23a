// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/argument_parsing.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/methods/registration_names.h"

namespace curvereg::cli {
namespace {

constexpr std::size_t kMaxNumbers = 16;
constexpr double kMaxSeconds = 1e9;  // clocks count nanoseconds in 64 bits

// The numbers in `text`; nullopt when a word is no finite number or there are more than kMaxNumbers.
std::optional<std::vector<double>> ParseNumbers(const std::string& text) {
  std::vector<double> numbers;
  for (const absl::string_view word : absl::StrSplit(text, absl::ByAnyChar(" ,;\t\r\n"), absl::SkipEmpty())) {
    double number = 0.0;
    if (!absl::SimpleAtod(word, &number) || !std::isfinite(number) || numbers.size() == kMaxNumbers) {
      return std::nullopt;
    }
    numbers.push_back(number);
  }
  return numbers;
}

std::optional<std::vector<double>> ReadNumbers(const std::string& path) {
  std::ifstream file(path);
  std::string line, text;
  while (std::getline(file, line) && text.size() < 4096) text += line.substr(0, line.find('#')) + "\n";
  return ParseNumbers(text);
}

absl::Status NotATransform(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(
      what,
      ": not a rigid transform; expected 16 or 12 numbers (rows of a 4x4 or 3x4 matrix), 7 (x y z qx qy qz qw) "
      "or 8 (TUM line)"));
}

std::optional<RigidTransform> FromPose(const double* xyz_quaternion) {
  const Eigen::Map<const Eigen::Matrix<double, 7, 1>> v(xyz_quaternion);
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > 1e-3) return std::nullopt;
  return Eigen::Translation3d(v.head<3>()) * q.normalized();
}

std::optional<RigidTransform> FromRows(const std::vector<double>& numbers) {
  if (numbers.size() == 16 && !(numbers[12] == 0.0 && numbers[13] == 0.0 && numbers[14] == 0.0 && numbers[15] == 1.0)) {
    return std::nullopt;
  }
  RigidTransform T = RigidTransform::Identity();
  T.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  if (!IsRigid(T, 1e-3)) return std::nullopt;
  return Orthonormalised(T);
}

std::optional<RigidTransform> FromNumbers(const std::vector<double>& numbers) {
  switch (numbers.size()) {
    case 7:
      return FromPose(numbers.data());
    case 8:
      return FromPose(numbers.data() + 1);
    case 12:
    case 16:
      return FromRows(numbers);
    default:
      return std::nullopt;
  }
}

}  // namespace

absl::StatusOr<RigidTransform> ParseTransform(const std::string& text_or_path) {
  std::optional<std::vector<double>> numbers = ParseNumbers(text_or_path);
  std::error_code error;
  // A file may well have a number for a name; a transform is never a single number.
  if (!numbers || numbers->size() == 1) {
    if (std::filesystem::is_directory(text_or_path, error)) {
      return absl::InvalidArgumentError(absl::StrCat(text_or_path, ": is a folder, not a file with a transform"));
    }
    if (!std::ifstream(text_or_path)) {
      return absl::NotFoundError(absl::StrCat(text_or_path, ": neither a transform nor a readable file"));
    }
    numbers = ReadNumbers(text_or_path);
  }
  const std::optional<RigidTransform> T = numbers ? FromNumbers(*numbers) : std::nullopt;
  if (!T) return NotATransform(text_or_path);
  return *T;
}

absl::StatusOr<Eigen::Vector3d> ParseDirection(const std::string& text) {
  const std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers || numbers->size() != 3 ||
      std::all_of(numbers->begin(), numbers->end(), [](double v) { return v == 0.0; })) {
    return absl::InvalidArgumentError(absl::StrCat(text, ": expected a direction of gravity X,Y,Z other than zero"));
  }
  return Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

absl::StatusOr<Matrix6d> ParsePriorSigma(const std::string& text) {
  const std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers || numbers->size() != 2 || (*numbers)[0] <= 0.0 || (*numbers)[1] <= 0.0) {
    return absl::InvalidArgumentError(
        absl::StrCat("--prior-sigma: ", text, ": expected ROTATION_RAD,TRANSLATION_M, both positive"));
  }
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant((*numbers)[0]), Eigen::Vector3d::Constant((*numbers)[1]);
  return Matrix6d(sigma.cwiseAbs2().asDiagonal());
}

absl::StatusOr<Method> ParseMethod(const std::string& name) {
  const std::optional<Method> method = MethodFromName(name);
  if (method) return *method;
  return absl::InvalidArgumentError(absl::StrCat("unknown method '", name, "'; methods: ", MethodNames()));
}

absl::StatusOr<std::vector<Method>> ParseMethods(const std::string& names) {
  std::vector<Method> methods;
  for (const std::string& name : std::vector<std::string>(absl::StrSplit(names, ','))) {
    const absl::StatusOr<Method> method = ParseMethod(name);
    if (!method.ok()) return method.status();
    if (std::find(methods.begin(), methods.end(), *method) != methods.end()) {
      return absl::InvalidArgumentError(absl::StrCat("the method '", name, "' is given twice"));
    }
    methods.push_back(*method);
  }
  return methods;
}

std::string CheckPositive(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && value > 0.0) return {};
  return absl::StrCat("expected a number above 0, got '", text, "'");
}

std::string CheckSeconds(const std::string& text) {
  std::string error = CheckPositive(text);
  if (!error.empty() || std::strtod(text.c_str(), nullptr) <= kMaxSeconds) return error;
  return absl::StrCat("expected at most ", kMaxSeconds, " seconds, got '", text, "'");
}

std::string CheckNotNegative(const std::string& text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return {};
  return absl::StrCat("expected a whole number of at least 0, got '", text, "'");
}

std::string MethodNames() {
  return absl::StrJoin(AllMethods(), ", ", [](std::string* out, Method method) { out->append(MethodName(method)); });
}

}  // namespace curvereg::cli
