#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs every benchmark of a folder and keeps its results as JSON (with machine and date, as Google Benchmark writes them).
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
for bench in "${found[@]}"; do
  name=$(basename "$bench")
  printf '\n== %s\n' "$name"
  "$bench" --benchmark_counters_tabular=true --benchmark_out="$out/$name.json" --benchmark_out_format=json
done
printf '\nResults in %s\n' "$out"
