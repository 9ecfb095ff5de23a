#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds and runs the tests under a sanitizer: all of them under asan (addresses, leaks, undefined behaviour), those of
# the server, its client and what they share under tsan (threads). Fails at a failed test and at any report, also one of
# a program that a test has started and killed.
#
# A run without failures on a checkout without changes adds a line to tests/sanitizer_runs.txt: SANITIZER COMMIT DATE.
#
# usage: sanitizers.sh asan|tsan JOBS
#        sanitizers.sh last             prints when each last ran without a report, and how many commits came after it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
record=tests/sanitizer_runs.txt
preset=$1
if [ "$preset" = last ]; then
  for sanitizer in asan tsan; do
    read -r _ commit date < <(grep "^$sanitizer " "$record" | tail -n 1) || { echo "$sanitizer: no run is recorded"; continue; }
    echo "$sanitizer: clean on $commit, $date; $(git rev-list --count "$commit..HEAD" 2>/dev/null || echo '?') commits since"
  done
  exit 0
fi
jobs=$2
build=$PWD/build/$preset
reports=$build/reports

cmake --preset "$preset"
targets=(all)
selected=()
if [ "$preset" = tsan ]; then
  # Without integration/traverse_load: it measures times and memory, and its sixteen rovers alone take more than three
  # minutes here on two busy processors; traverse_cli and traverse_link run the same of the server.
  selected=(-R '^(server|client|wire)/|^integration/(server_|store_crash|cli_server|traverse_(cli|link)|tls)|^testing/tsan_grpc')
  mapfile -t targets < <(ninja -C "$build" -t targets all |
    grep -oE '^tests/((server|client|wire)_|integration_(server|store_crash|cli_server|traverse_(cli|link)|tls)|testing_tsan_grpc)[a-z0-9_]*test')
fi
ninja -C "$build" -j "$jobs" "${targets[@]}"

rm -rf "$reports"
mkdir -p "$reports"
export ASAN_OPTIONS=log_path=$reports/asan
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1:log_path=$reports/ubsan
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
export TSAN_OPTIONS=log_path=$reports/tsan:suppressions=$PWD/tests/tsan.supp
status=0
CURVEREG_TEST_IMAGE=0 ctest --test-dir "$build" --output-on-failure --no-tests=error -j "$jobs" "${selected[@]}" ||
  status=$?
found=$(find "$reports" -type f | sort)
if [ -n "$found" ]; then
  xargs cat <<<"$found"
  printf '\nsanitizers.sh: %d processes reported, see %s\n' "$(wc -l <<<"$found")" "$reports" >&2
  exit 1
fi
if [ "$status" -eq 0 ] && [ -z "$(git status --porcelain --untracked-files=no)" ]; then
  echo "$preset $(git rev-parse --short HEAD) $(date -u +%F)" >>"$record"
  echo "sanitizers.sh: recorded in $record"
fi
exit "$status"
