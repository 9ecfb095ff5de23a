// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report_pictures.h"

#include <fstream>
#include <sstream>
#include <vector>

#include "files/atomic_file.h"

namespace curvereg {
namespace {

std::string EvaluationTitle(const std::string& figure) {
  if (figure.starts_with("figure_1_")) return "Error distributions";
  if (figure.starts_with("figure_2_")) return "Run time";
  if (figure.starts_with("figure_3_")) return "Trajectory";
  if (figure.starts_with("figure_5_")) return "Error along the drive";
  return "Merged map, coloured by height";
}

std::string TraverseTitle(const std::string& figure) {
  if (figure.starts_with("figure_1_")) return "Trajectory, with ellipses of two standard deviations";
  if (figure.starts_with("figure_2_")) return "Map, coloured by height";
  return "Verdicts";
}

std::string FileBytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

}  // namespace

absl::StatusOr<std::string> WritePage(const std::string& folder, const FigureOptions& figures, Drawing drawing,
                                      HtmlPageContent content) {
  const absl::StatusOr<std::vector<std::string>> drawn = DrawFigures(folder, drawing, figures);
  content.note = drawn.ok() ? "" : std::string(drawn.status().message());
  if (drawn.ok()) {
    for (const std::string& name : *drawn) {
      const std::string title = drawing == Drawing::kTraverse ? TraverseTitle(name) : EvaluationTitle(name);
      content.pictures.push_back({.title = title, .png = FileBytes(folder + "/" + name)});
    }
  }
  const absl::Status written = WriteFileAtomically(folder + "/report.html", HtmlPage(content));
  if (!written.ok()) return written;
  return content.note;
}

}  // namespace curvereg
