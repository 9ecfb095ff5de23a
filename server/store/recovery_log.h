// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the log says of a store that was opened.
#ifndef CURVEREG_SERVER_STORE_RECOVERY_LOG_H_
#define CURVEREG_SERVER_STORE_RECOVERY_LOG_H_

#include <string>

#include "server/operations/logging.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// Errors for damage, orphaned files and uploads without their bytes, then what the store holds. `folder`: the store's.
void LogRecovery(ScanStore& store, const std::string& folder, Logger& logger);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_RECOVERY_LOG_H_
