#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Share of the sources' lines that the unit tests run, per folder. Needs no package besides gcc: gcov counts.
#
# usage: coverage.sh JOBS
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=$1
build=$PWD/build/coverage
cmake --preset coverage
cmake --build --preset coverage -j "$jobs"
find "$build" -name '*.gcda' -delete
ctest --preset coverage -j "$jobs" -L unit
# gcov prints "File 'PATH'" and "Lines executed:P% of N" for each source of each object; a source counts with its best.
find "$build" -name '*.gcda' -print0 | (cd "$build" && xargs -0 gcov --no-output --relative-only \
  --source-prefix "$(git rev-parse --show-toplevel)" 2>/dev/null) |
  awk -F"'" '
    /^File / { file = $2 }
    /^Lines executed:/ && file != "" {
      split($0, part, /[:%]| of /); share = part[2]; lines = part[4]
      if (file ~ /\.(cc|h)$/ && file !~ /^(tests|build)\// && share * lines / 100 > run[file]) run[file] = share * lines / 100
      if (lines > all[file]) all[file] = lines
      file = ""
    }
    END {
      for (file in run) { folder = file; sub(/\/[^\/]*$/, "", folder); r[folder] += run[file]; n[folder] += all[file] }
      for (folder in r) printf "%-24s %6d lines %5.1f %%\n", folder, n[folder], 100 * r[folder] / n[folder]
    }' | sort
