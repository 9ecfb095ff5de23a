// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Strangers: pairs of a data set that share no ground. There is no true pose; every accepted one is wrong.
#ifndef CURVEREG_EVAL_STRANGERS_H_
#define CURVEREG_EVAL_STRANGERS_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "eval/dataset.h"

namespace curvereg {

struct StrangerPair {
  std::string source;  // scan names, as in ScanPair
  std::string target;
};

// Reads `strangers.txt` in the data set's folder: lines "source target", '#' starts a comment. Empty when there is no
// such file. INVALID_ARGUMENT naming file and line: not two words, or a scan that the data set does not have.
absl::StatusOr<std::vector<StrangerPair>> LoadStrangers(const Dataset& dataset);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_STRANGERS_H_
