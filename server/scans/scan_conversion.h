// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Stored scans, from the store to the contract.
#ifndef CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_
#define CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_

#include "curvereg/v1/scan_service.pb.h"
#include "server/store/scan_store.h"

namespace curvereg::server {

// The scan as the contract has it, with its name.
v1::Scan ToWire(const StoredScan& scan);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_SCANS_SCAN_CONVERSION_H_
