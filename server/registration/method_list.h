// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What ListMethods answers.
#ifndef CURVEREG_SERVER_REGISTRATION_METHOD_LIST_H_
#define CURVEREG_SERVER_REGISTRATION_METHOD_LIST_H_

#include "curvereg/v1/registration_service.pb.h"
#include "server/settings/server_config.h"

namespace curvereg::server {

// Every method of the core with the options that it heeds, and the limits, which are resolved.
v1::ListMethodsResponse DescribeMethods(const LimitsConfig& limits);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_REGISTRATION_METHOD_LIST_H_
