#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs every benchmark of a folder and keeps what each prints, with machine and commit above it, in OUT_DIR/NAME.txt.
#
# usage: bench.sh BENCHMARK_DIR OUT_DIR
set -euo pipefail
benchmarks=$1
out=$2
mkdir -p "$out"
shopt -s nullglob
found=("$benchmarks"/*_bench)
if [ ${#found[@]} -eq 0 ]; then
  echo "bench.sh: no benchmark in $benchmarks; run 'make build' first" >&2
  exit 1
fi
processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)
commit=$(git describe --always --dirty 2>/dev/null || echo 'no commit')
for bench in "${found[@]}"; do
  name=$(basename "$bench")
  printf '\n== %s\n' "$name"
  {
    printf '# %s, %s processors, commit %s, %s\n' "$processor" "$(nproc)" "$commit" "$(date -u +%FT%TZ)"
    "$bench"
  } | tee "$out/$name.txt"
done
printf '\nResults in %s\n' "$out"
