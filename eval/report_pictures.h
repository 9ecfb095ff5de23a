// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The page of a report, with the figures that are drawn from the folder's files.
#ifndef CURVEREG_EVAL_REPORT_PICTURES_H_
#define CURVEREG_EVAL_REPORT_PICTURES_H_

#include <string>

#include "absl/status/statusor.h"
#include "eval/figures.h"
#include "eval/report_html.h"

namespace curvereg {

// Draws the figures and writes `folder`/report.html: the content with a titled picture of each, or with a note on why
// there are none. Returns the note, empty when the figures were drawn; errors of WriteFileAtomically.
absl::StatusOr<std::string> WritePage(const std::string& folder, const FigureOptions& figures, Drawing drawing,
                                      HtmlPageContent content);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_PICTURES_H_
