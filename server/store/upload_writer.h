// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes one upload of a store, piece by piece, until it is a scan.
#ifndef CURVEREG_SERVER_STORE_UPLOAD_WRITER_H_
#define CURVEREG_SERVER_STORE_UPLOAD_WRITER_H_

#include <memory>

#include "server/store/scan_changes.h"
#include "server/store/scan_store.h"
#include "server/store/upload_table.h"

namespace curvereg::server {

// `uploads`, which gave the grant, and `scans`, which the upload becomes one of, outlive the writer.
std::unique_ptr<UploadWriter> MakeUploadWriter(UploadTable::Grant grant, UploadTable& uploads, ScanChanges& scans);

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_STORE_UPLOAD_WRITER_H_
