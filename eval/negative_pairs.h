// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Negative pairs of a data set: pairs of scans that do not overlap. There is no true pose; every accepted one is wrong.
#ifndef CURVEREG_EVAL_NEGATIVE_PAIRS_H_
#define CURVEREG_EVAL_NEGATIVE_PAIRS_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "eval/dataset.h"

namespace curvereg {

struct NegativePair {
  std::string source;  // scan names, as in ScanPair
  std::string target;
};

// The file of negative pairs in the data set's folder: `negatives.txt`, else `strangers.txt`, its name before, which is
// read in this release only. Empty: there is none.
std::string NegativePairsFile(const std::string& folder);

// True when `path` has the name before.
bool IsOldNegativePairsFile(const std::string& path);

// Reads that file: lines "source target", '#' starts a comment. Empty when there is none. INVALID_ARGUMENT naming file
// and line: not two words, or a scan that the data set does not have.
absl::StatusOr<std::vector<NegativePair>> LoadNegativePairs(const Dataset& dataset);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_NEGATIVE_PAIRS_H_
