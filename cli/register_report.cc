// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/register_report.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "cli/result_text.h"
#include "files/atomic_file.h"
#include "files/json.h"
#include "files/result_json.h"
#include "render/cloud_pictures.h"
#include "render/png.h"

namespace curvereg::cli {
namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Curvereg registration</title>
<style>body { font-family: sans-serif; margin: 2em auto; max-width: 60em; } img { max-width: 100%; border: 1px solid #ddd; }
.target { color: #4682c8; } .source { color: #f08c28; }</style></head><body>
)";

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

absl::StatusOr<std::string> Picture(const NamedScans& scans, const RigidTransform& T_target_source,
                                    Projection projection, const std::string& title) {
  Plot plot = OverlayPlot(scans.source, scans.target, T_target_source, projection);
  plot.title = title;
  const absl::StatusOr<std::string> png = EncodePng(FramedPlot(plot));
  if (!png.ok()) return png.status();
  return absl::StrCat("<p><img alt=\"", title, "\" src=\"data:image/png;base64,", absl::Base64Escape(*png), "\">\n");
}

absl::StatusOr<std::string> Page(const NamedScans& scans, const RegistrationResult& result) {
  std::string html = absl::StrCat(kHead, "<h1>", result.verdict.accepted ? "Accepted" : "Rejected",
                                  "</h1>\n<p><span class=\"source\">source ", Escaped(scans.source_name),
                                  "</span> on <span class=\"target\">target ", Escaped(scans.target_name),
                                  "</span></p>\n<pre>", Escaped(RegistrationText(result)), "</pre>\n");
  struct View {
    const char* title;
    Projection projection;
    bool moved;
  };
  for (const View& view : {View{"Registered, from above", Projection::kFromAbove, true},
                           View{"Registered, from the side", Projection::kFromTheSide, true},
                           View{"As given, from above", Projection::kFromAbove, false}}) {
    if (view.moved && !result.T_target_source.has_value()) continue;
    const RigidTransform T = view.moved ? *result.T_target_source : RigidTransform::Identity();
    const absl::StatusOr<std::string> picture = Picture(scans, T, view.projection, view.title);
    if (!picture.ok()) return picture.status();
    html += *picture;
  }
  return html + "</body></html>\n";
}

}  // namespace

absl::Status WriteRegisterReport(const std::string& folder, const NamedScans& scans, const RegistrationResult& result) {
  Json json = {{"source", scans.source_name}, {"target", scans.target_name}};
  json.Update(ResultJson(result));
  const absl::Status status = WriteFileAtomically(folder + "/result.json", JsonText(json, 1) + "\n");
  if (!status.ok()) return status;
  const absl::StatusOr<std::string> page = Page(scans, result);
  if (!page.ok()) return page.status();
  return WriteFileAtomically(folder + "/report.html", *page);
}

}  // namespace curvereg::cli
