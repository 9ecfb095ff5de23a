#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/check_arrows.py on small tables and sources."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import check_arrows  # noqa: E402

TABLE = "core/base:\ncore/scan: core/base\nwire: core/*\n"
BASE = {"core/base/hash.h": "", "core/scan/scan.h": '#include "core/base/hash.h"\n', "wire/error.h": '#include "core/scan/scan.h"\n'}


class CheckArrowsTest(unittest.TestCase):
    def findings(self, files, table=TABLE):
        return check_arrows.check({**BASE, **files}, table)

    def test_allowed_includes_are_no_finding(self):
        self.assertEqual(self.findings({}), [])

    def test_includes_within_a_folder_and_of_libraries_are_no_finding(self):
        self.assertEqual(self.findings({"core/base/a.h": '#include "core/base/hash.h"\n#include "absl/status/status.h"\n'}), [])

    def test_an_include_that_runs_up_is_named_with_its_line(self):
        self.assertEqual(self.findings({"core/base/up.cc": '// up\n#include "core/scan/scan.h"\n'}),
                         ["core/base/up.cc:2: core/base must not include core/scan/scan.h"])

    def test_a_folder_without_a_line_is_a_finding(self):
        self.assertEqual(self.findings({"new/a.cc": ""}), [f"new/a.cc: {check_arrows.TABLE} has no line for new"])

    def test_the_table_itself_cannot_name_what_lies_above(self):
        table = "core/base: wire\n" + TABLE[len("core/base:\n"):]
        self.assertIn(f"{check_arrows.TABLE}:1: core/base may not name wire, which is not on a line above it",
                      self.findings({}, table))

    def test_an_arrow_that_nothing_uses_is_a_finding(self):
        self.assertEqual(self.findings({"wire/error.h": ""}), [f"{check_arrows.TABLE}: no include uses wire -> core/*"])

    def test_the_project_holds(self):
        self.assertEqual(check_arrows.main(), 0)


if __name__ == "__main__":
    unittest.main()
