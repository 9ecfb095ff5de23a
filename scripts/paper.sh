#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# The paper's section 5: simulates its three data sets, evaluates its method, its baselines and the default method, prints
# its tables and draws its figures. The baselines take up to a quarter of an hour per pair, so by default they register
# one pair of each set.
#
# usage: paper.sh [OUT_DIR]      default: out/paper
#   CURVEREG        another executable
#   BASELINE_PAIRS  pairs per baseline and set (default 1; 0: none); RIVAL_PAIRS, its old name, is read in this release
#   PAPER_SCANS     maximum number of scans of a set
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
curvereg=${CURVEREG:-build/release/bin/curvereg}
out=${1:-out/paper}
if [ -n "${RIVAL_PAIRS:-}" ]; then
  echo 'paper.sh: RIVAL_PAIRS is called BASELINE_PAIRS now; the old name will not be read in the next release' >&2
fi
baseline_pairs=${BASELINE_PAIRS:-${RIVAL_PAIRS:-1}}

if [ ! -x "$curvereg" ]; then
  echo "paper.sh: $curvereg is not there; run 'make paper' or 'make build' first" >&2
  exit 1
fi
rm -rf "$out"
mkdir -p "$out"

run() {
  printf '      $ %s\n' "$*" >&2
  local status=0
  "$@" >"$out/last.txt" || status=$?
  if [ "$status" -ne 0 ]; then
    echo "paper.sh: the command above ended with exit status $status" >&2
    exit "$status"
  fi
}

# evaluate_set SET SCANS EVERY TAKE: with pairs of scan i + EVERY onto scan i, every TAKE-th of them
evaluate_set() {
  local set=$1 scans=$2 every=$3 take=$4
  [ -z "${PAPER_SCANS:-}" ] || [ "$PAPER_SCANS" -ge "$scans" ] || scans=$PAPER_SCANS
  local num_pairs=$(((scans - every + take - 1) / take))
  run "$curvereg" simulate --preset "$set" --scans "$scans" --out "$out/scans/$set"
  run "$curvereg" evaluate "$out/scans/$set" --every "$every" --take "$take" --method paper,curvelet \
    --out "$out/$set/quick"
  [ "$baseline_pairs" -gt 0 ] || return 0
  local baseline_take=$((take * ((num_pairs + baseline_pairs - 1) / baseline_pairs)))
  run "$curvereg" evaluate "$out/scans/$set" --every "$every" --take "$baseline_take" \
    --method fpfh-sac-ia,harris3d-fpfh --out "$out/$set/baselines"
}

evaluate_set mars-dome 95 5 5
evaluate_set mars-yard-sim 40 1 1
evaluate_set mars-yard-real 17 1 1
rm -rf "$out/scans" "$out/last.txt"
/usr/bin/python3 eval/paper_tables.py "$out"
