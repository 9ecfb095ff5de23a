// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/harris3d_fpfh.h"

#include "tests/core/baselines/baseline_contract.h"

namespace curvereg::testing {

INSTANTIATE_TEST_SUITE_P(Harris3dFpfh, BaselineContract, ::testing::Values(&RegisterHarris3dFpfh));

}  // namespace curvereg::testing
