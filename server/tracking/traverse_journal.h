// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The record of one traverse. The database has every change of it before anybody sees it.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_JOURNAL_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_JOURNAL_H_

#include <functional>
#include <mutex>
#include <utility>

#include "absl/status/status.h"
#include "server/tracking/traverse_store.h"

namespace curvereg::server {

// Safe to use from several threads.
class TraverseJournal {
 public:
  // `record`: as the database has it.
  explicit TraverseJournal(TraverseRecord record) : record_(std::move(record)) {}

  TraverseRecord record() const;

  // Runs `change` on a copy of the record, which it changes and writes to the database; where it answers OK, the copy
  // becomes the record. One at a time. After Close: `error_when_closed`, without running it.
  absl::Status Change(const std::function<absl::Status(TraverseRecord& record)>& change,
                      const absl::Status& error_when_closed);

  // The record stays as it is from here on.
  void Close();
  bool is_closed() const;

 private:
  mutable std::mutex mutex_;  // held while the database is changed
  TraverseRecord record_;
  bool is_closed_ = false;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_JOURNAL_H_
