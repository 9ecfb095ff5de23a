// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTING_PATIENCE_H_
#define CURVEREG_TESTING_PATIENCE_H_

namespace curvereg::testing {

// How many times longer computing may take than in the build that is shipped: sanitizers slow it down. For the limits
// of tests only that hold our own computing; what waits for a clock is as quick as ever.
#ifdef CURVEREG_SANITIZED
inline constexpr int kPatience = 10;
#else
inline constexpr int kPatience = 1;
#endif

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTING_PATIENCE_H_
