// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report_html.h"

#include <cmath>
#include <string_view>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/methods/registration_names.h"

namespace curvereg {
namespace {

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Curvereg evaluation</title>
<style>
body { font-family: sans-serif; margin: 2em auto; max-width: 75em; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.25em 0.7em; border-bottom: 1px solid #ddd; text-align: right; font-variant-numeric: tabular-nums; }
th { background: #f4f4f4; vertical-align: bottom; }
th:first-child, td:first-child, td.text { text-align: left; }
td.bad { color: #b00020; font-weight: bold; }
img { max-width: 100%; }
.note { background: #fff4d6; padding: 0.6em 1em; }
</style></head><body>
)";

// "–" where there is no number.
std::string Number(double value) { return std::isfinite(value) ? absl::StrFormat("%.4g", value) : "–"; }

std::string Cell(const std::string& content) { return absl::StrCat("<td>", content, "</td>"); }
std::string TextCell(const std::string& content) { return absl::StrCat("<td class=\"text\">", content, "</td>"); }
std::string CountCell(int count, bool zero_is_good) {
  return absl::StrCat(zero_is_good && count > 0 ? "<td class=\"bad\">" : "<td>", count, "</td>");
}

std::string HeaderRow(const std::vector<std::string>& names) {
  return absl::StrCat("<tr><th>", absl::StrJoin(names, "</th><th>"), "</th></tr>\n");
}

std::string SummaryRow(const MethodEvaluation& run) {
  const MethodSummary& s = run.summary;
  return absl::StrCat("<tr><td>", std::string(MethodName(run.method)), "</td>", Cell(absl::StrCat(s.pairs)),
                      Cell(absl::StrCat(s.ok)), Cell(absl::StrCat(s.accepted)), CountCell(s.accepted_wrong, true),
                      CountCell(s.rejected_right, false), CountCell(s.no_pose, false),
                      Cell(absl::StrCat(s.negatives_accepted, " of ", s.negatives)), Cell(Number(s.rmse_translation_m)),
                      Cell(Number(s.median_translation_m)), Cell(Number(s.rmse_rotation_rad)),
                      Cell(Number(s.median_rotation_rad)), Cell(Number(s.rmse_ok_translation_m)),
                      Cell(Number(s.rmse_ok_rotation_rad)), Cell(Number(s.median_s)), Cell(Number(s.p95_s)), "</tr>\n");
}

std::string SummaryTable(const Evaluation& evaluation) {
  std::string table = "<table>\n";
  absl::StrAppend(
      &table, HeaderRow({"method", "pairs", "ok", "accepted", "accepted<br>wrong", "rejected<br>right", "no pose",
                         "negatives<br>accepted", "RMSE<br>[m]", "median<br>[m]", "RMSE<br>[rad]", "median<br>[rad]",
                         "RMSE ok<br>[m]", "RMSE ok<br>[rad]", "median<br>[s]", "p95<br>[s]"}));
  for (const MethodEvaluation& run : evaluation.methods) absl::StrAppend(&table, SummaryRow(run));
  return absl::StrCat(table, "</table>\n");
}

std::string Judgement(const PairOutcome& outcome) {
  if (!outcome.error.empty()) return "call failed";
  const bool ok = IsOk(outcome);
  if (outcome.result.verdict.accepted) return ok ? "right" : "accepted wrong";
  if (ok) return "rejected right";
  if (!outcome.true_T_target_source) return "negative rejected";
  return outcome.result.T_target_source.has_value() ? "rejected wrong" : "no pose";
}

std::string Reasons(const PairOutcome& outcome) {
  if (!outcome.error.empty()) return Escaped(outcome.error);
  return absl::StrJoin(outcome.result.verdict.reasons, ", ",
                       [](std::string* out, Reason reason) { out->append(ReasonName(reason)); });
}

std::string OutcomeRow(const PairOutcome& outcome) {
  const TransformDifference error = PoseError(outcome);
  return absl::StrCat("<tr><td>", Escaped(outcome.source), " → ", Escaped(outcome.target), "</td>",
                      Cell(Number(error.translation_m)), Cell(Number(error.rotation_rad)),
                      Cell(Number(outcome.seconds)), TextCell(Judgement(outcome)), TextCell(Reasons(outcome)),
                      "</tr>\n");
}

bool IsFailure(const PairOutcome& outcome) {
  if (!outcome.true_T_target_source) return outcome.result.verdict.accepted || !outcome.error.empty();
  return !IsOk(outcome) || !outcome.result.verdict.accepted;
}

std::string PairsTable(const MethodEvaluation& run, bool failures_only) {
  std::string rows;
  for (const PairOutcome& outcome : run.outcomes) {
    if (!failures_only || IsFailure(outcome)) absl::StrAppend(&rows, OutcomeRow(outcome));
  }
  if (rows.empty()) return "<p>None.</p>\n";
  return absl::StrCat("<table>\n", HeaderRow({"pair", "error [m]", "error [rad]", "seconds", "judgement", "reasons"}),
                      rows, "</table>\n");
}

std::string PairsSections(const Evaluation& evaluation) {
  std::string html;
  for (const MethodEvaluation& run : evaluation.methods) {
    const std::string name(MethodName(run.method));
    absl::StrAppend(&html, "<h2>Failures of ", name, "</h2>\n", PairsTable(run, true), "<details><summary>All ",
                    run.outcomes.size(), " pairs of ", name, "</summary>\n", PairsTable(run, false), "</details>\n");
  }
  return html;
}

}  // namespace

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

std::string HtmlPage(const HtmlPageContent& content) {
  std::string html = absl::StrCat(kHead, "<h1>", Escaped(content.title), "</h1>\n", content.summary);
  if (!content.note.empty()) absl::StrAppend(&html, "<p class=\"note\">", Escaped(content.note), "</p>\n");
  for (const ReportPicture& picture : content.pictures) {
    absl::StrAppend(&html, "<h2>", Escaped(picture.title), "</h2>\n<img alt=\"", Escaped(picture.title),
                    "\" src=\"data:image/png;base64,", absl::Base64Escape(picture.png), "\">\n");
  }
  return absl::StrCat(html, content.details, "</body></html>\n");
}

HtmlPageContent EvaluationPage(const Evaluation& evaluation) {
  return {
      .title = "Evaluation of " + evaluation.dataset,
      .summary = absl::StrCat("<p>A pair is ok if its error is below 0.5 m and 0.1 rad. RMSE and medians ",
                              "exclude pairs without a pose, which count as failures.</p>\n", SummaryTable(evaluation)),
      .details = PairsSections(evaluation)};
}

}  // namespace curvereg
