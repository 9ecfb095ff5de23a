// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a server does before it is ready: plans the FFTs and registers two scans of made-up ground with a known motion.
#ifndef CURVEREG_SERVER_WARM_UP_H_
#define CURVEREG_SERVER_WARM_UP_H_

#include "absl/status/status.h"

namespace curvereg::server {

// INTERNAL: the registration did not find the motion; this program must not answer anybody.
absl::Status WarmUp();

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_WARM_UP_H_
