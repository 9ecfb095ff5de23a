// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/fpfh_sac_ia.h"

#include "tests/core/baselines/baseline_contract.h"

namespace curvereg::testing {

INSTANTIATE_TEST_SUITE_P(FpfhSacIa, BaselineContract, ::testing::Values(&RegisterFpfhSacIa));

}  // namespace curvereg::testing
