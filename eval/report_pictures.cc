// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report_pictures.h"

#include <fstream>
#include <sstream>

namespace curvereg {
namespace {

std::string TitleOf(const std::string& figure) {
  if (figure.starts_with("figure_1_")) return "Error distributions";
  if (figure.starts_with("figure_2_")) return "Run time";
  if (figure.starts_with("figure_3_")) return "Trajectory";
  if (figure.starts_with("figure_5_")) return "Error along the drive";
  return "Merged map, coloured by height";
}

std::string FileBytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

}  // namespace

DrawnPictures DrawReportPictures(const std::string& folder, const FigureOptions& options) {
  const absl::StatusOr<std::vector<std::string>> figures = DrawFigures(folder, options);
  DrawnPictures drawn;
  if (!figures.ok()) {
    drawn.warning = std::string(figures.status().message());
    return drawn;
  }
  for (const std::string& name : *figures) {
    drawn.pictures.push_back({.title = TitleOf(name), .png = FileBytes(folder + "/" + name)});
  }
  return drawn;
}

}  // namespace curvereg
