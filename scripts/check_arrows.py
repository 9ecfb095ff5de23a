#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Holds every include of the sources against scripts/folder_arrows.txt and prints what differs, a finding a line.

usage: check_arrows.py      in a git clone; exit status 1 when there is a finding
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = "scripts/folder_arrows.txt"
# They stand on top of everything and nothing includes them.
OUTSIDE = ("bench/", "examples/", "findings/", "fuzz/", "tests/", "cmake/")
INCLUDE = re.compile(r'^#include "([^"]+)"')


def read_table(text):
    """The allowed arrows {folder: [named folder or pattern]}, and what is wrong with the table itself."""
    allowed, findings = {}, []
    for number, line in enumerate(text.splitlines(), 1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        folder, _, targets = line.partition(":")
        for target in targets.split():
            known = any(name.startswith("core") for name in allowed) if target == "core/*" else target in allowed
            if not known:
                findings.append(f"{TABLE}:{number}: {folder} may not name {target}, which is not on a line above it")
        allowed[folder] = targets.split()
    return allowed, findings


def is_allowed(target, targets):
    return target in targets or ("core/*" in targets and (target == "core" or target.startswith("core/")))


def check(files, table_text):
    """files: {path: text} of all sources. Returns the findings."""
    allowed, findings = read_table(table_text)
    used = set()
    for path, text in sorted(files.items()):
        folder = path.rpartition("/")[0]
        if folder not in allowed:
            findings.append(f"{path}: {TABLE} has no line for {folder}")
            continue
        for number, line in enumerate(text.splitlines(), 1):
            match = INCLUDE.match(line)
            if not match or match[1] not in files:
                continue
            target = match[1].rpartition("/")[0]
            if target == folder:
                continue
            used.add((folder, target))
            if not is_allowed(target, allowed[folder]):
                findings.append(f"{path}:{number}: {folder} must not include {match[1]}")
    for folder, targets in allowed.items():
        for target in targets:
            if target == "core/*":
                is_used = any(to == "core" or to.startswith("core/") for of, to in used if of == folder)
            else:
                is_used = (folder, target) in used
            if not is_used:
                findings.append(f"{TABLE}: no include uses {folder} -> {target}")
    return findings


def main():
    listed = subprocess.run(["git", "ls-files", "-z", "*.h", "*.cc"], cwd=ROOT, check=True, stdout=subprocess.PIPE)
    paths = [path for path in listed.stdout.decode().split("\0") if path and not path.startswith(OUTSIDE)]
    files = {path: (ROOT / path).read_text() for path in paths if (ROOT / path).is_file()}
    findings = check(files, (ROOT / TABLE).read_text())
    print("\n".join(findings), end="\n" if findings else "")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
