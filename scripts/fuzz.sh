#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs every libFuzzer target of a build folder for some seconds each; ends at the first one that finds a fault.
# Begins with fuzz/seeds/TARGET; inputs that reach new code are kept in out/fuzz/TARGET/corpus for the next run.
#
# usage: fuzz.sh BUILD_DIR SECONDS
set -euo pipefail
build=$1
seconds=$2
# An earlier build may have left targets that are no more.
mapfile -t fuzzers < <(find "$build" -type f -executable -name '*_fuzzer' | sort | while read -r fuzzer; do
  [ ! -d "fuzz/seeds/$(basename "$fuzzer")" ] || echo "$fuzzer"
done)
if [ ${#fuzzers[@]} -eq 0 ]; then
  echo "fuzz.sh: no *_fuzzer in $build; run 'make fuzz'" >&2
  exit 1
fi
# Services under test force their changes to disk: in memory that is quick.
[ ! -w /dev/shm ] || export TMPDIR=${TMPDIR:-/dev/shm}
for fuzzer in "${fuzzers[@]}"; do
  name=$(basename "$fuzzer")
  work=out/fuzz/$name
  mkdir -p "$work/corpus"
  printf '\n== %s for %s s\n' "$name" "$seconds"
  "$fuzzer" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="$work/" "$work/corpus" "fuzz/seeds/$name"
done
printf '\n%d fuzzers, no fault found\n' ${#fuzzers[@]}
