// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The figures of a report folder, drawn and read for its HTML page.
#ifndef CURVEREG_EVAL_REPORT_PICTURES_H_
#define CURVEREG_EVAL_REPORT_PICTURES_H_

#include <string>
#include <vector>

#include "eval/figures.h"
#include "eval/report_html.h"

namespace curvereg {

struct DrawnPictures {
  std::vector<ReportPicture> pictures;
  std::string warning;  // why there are none; empty when all went well
};

// DrawFigures, with a title for each picture.
DrawnPictures DrawReportPictures(const std::string& folder, const FigureOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_PICTURES_H_
