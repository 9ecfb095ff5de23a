// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tables of the database of traverses.
#ifndef CURVEREG_SERVER_TRACKING_TRAVERSE_TABLES_H_
#define CURVEREG_SERVER_TRACKING_TRAVERSE_TABLES_H_

#include "server/store/database_schema.h"

namespace curvereg::server {

inline Migrations TraverseTables() {
  return {{
      // AUTOINCREMENT: a page token is a place in this order.
      R"(CREATE TABLE traverses(
           number INTEGER PRIMARY KEY AUTOINCREMENT,
           id TEXT NOT NULL UNIQUE,
           traverse BLOB NOT NULL,
           num_events INTEGER NOT NULL DEFAULT 0,
           num_segments_begun INTEGER NOT NULL DEFAULT 0,
           num_linked_scans INTEGER NOT NULL DEFAULT 0,
           num_links INTEGER NOT NULL DEFAULT 0,
           num_revised_links INTEGER NOT NULL DEFAULT 0,
           num_revised_scans INTEGER NOT NULL DEFAULT 0) STRICT)",
      // AUTOINCREMENT: a stream of a removed traverse has no rights in another of the same name.
      R"(CREATE TABLE streams(
           fencing INTEGER PRIMARY KEY AUTOINCREMENT,
           traverse_number INTEGER NOT NULL UNIQUE) STRICT)",
      R"(CREATE TABLE scans(
           traverse INTEGER NOT NULL,
           sequence INTEGER NOT NULL,
           scan_id TEXT NOT NULL,
           header BLOB NOT NULL,
           time_ns INTEGER NOT NULL,
           PRIMARY KEY(traverse, sequence)) STRICT)",
      "CREATE INDEX scans_by_id ON scans(scan_id)",
      "CREATE TABLE doomed_scans(scan_id TEXT PRIMARY KEY) STRICT",
      R"(CREATE TABLE poses(
           traverse INTEGER NOT NULL,
           sequence INTEGER NOT NULL,
           pose BLOB NOT NULL,
           PRIMARY KEY(traverse, sequence)) STRICT)",
      R"(CREATE TABLE links(
           traverse INTEGER NOT NULL,
           number INTEGER NOT NULL,
           source INTEGER NOT NULL,
           target INTEGER NOT NULL,
           kind INTEGER NOT NULL,
           result BLOB NOT NULL,
           PRIMARY KEY(traverse, number)) STRICT)",
      // sequence: of the scan whose result it is, else -1.
      R"(CREATE TABLE events(
           traverse INTEGER NOT NULL,
           number INTEGER NOT NULL,
           sequence INTEGER NOT NULL,
           event BLOB NOT NULL,
           PRIMARY KEY(traverse, number)) STRICT)",
      "CREATE UNIQUE INDEX results ON events(traverse, sequence) WHERE sequence >= 0",
  }};
}

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_TRACKING_TRAVERSE_TABLES_H_
