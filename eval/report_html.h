// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// One HTML file that holds the whole report: tables, failures and the pictures themselves. Opens without a network.
#ifndef CURVEREG_EVAL_REPORT_HTML_H_
#define CURVEREG_EVAL_REPORT_HTML_H_

#include <string>
#include <vector>

#include "eval/evaluate.h"

namespace curvereg {

struct ReportPicture {
  std::string title;
  std::string png;  // the file's bytes
};

struct HtmlPageContent {
  std::string title = "";    // plain text
  std::string summary = "";  // HTML, above the pictures
  std::string note = "";     // plain text: why there are no pictures; may be empty
  std::vector<ReportPicture> pictures = {};
  std::string details = "";  // HTML, below the pictures
};
std::string HtmlPage(const HtmlPageContent& content);
std::string Escaped(const std::string& text);  // for use in HTML

// The page of an evaluation of pairs, without its pictures. Deterministic.
HtmlPageContent EvaluationPage(const Evaluation& evaluation);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_HTML_H_
