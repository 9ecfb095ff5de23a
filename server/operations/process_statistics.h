// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the operating system knows of this process.
#ifndef CURVEREG_SERVER_OPERATIONS_PROCESS_STATISTICS_H_
#define CURVEREG_SERVER_OPERATIONS_PROCESS_STATISTICS_H_

namespace curvereg::server {

// Numbers as Prometheus takes them; 0 where the system does not tell.
struct ProcessStatistics {
  double cpu_seconds = 0.0;  // user and system
  double resident_bytes = 0.0;
  double virtual_bytes = 0.0;
  double start_time_seconds = 0.0;  // since 1970
  double num_open_files = 0.0;
  double max_open_files = 0.0;
  double num_threads = 0.0;
};

ProcessStatistics ReadProcessStatistics();

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_PROCESS_STATISTICS_H_
