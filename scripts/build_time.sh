#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Processor time (user + system) of clean builds with an empty cache, of this checkout and of another commit, side by
# side on one machine: first the two programs, then all that `make test` builds. Each is configured in a folder of its
# own, which is removed at the end; ccache is off. Only what is committed is built.
#
# usage: build_time.sh [BASE_COMMIT]     default: add5d08, the commit before the layout in folders
#
# Prints a table; JOBS sets the number of compilations at once (one per processor). Builds the pair in turns, the base
# first, once each: RUNS=2 does all of it twice.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
base=${1:-add5d08}
jobs=${JOBS:-$(nproc)}
runs=${RUNS:-1}
export CCACHE_DISABLE=1
work=$(mktemp -d)
cleanup() {
  git worktree remove --force "$work/base" 2>/dev/null || true
  git worktree remove --force "$work/here" 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
git worktree add --quiet --detach "$work/base" "$base"
git worktree add --quiet --detach "$work/here" HEAD

seconds_of() {  # seconds_of COMMAND...: processor seconds of the command and its children
  local times
  # shellcheck disable=SC2016
  times=$(bash -c 'TIMEFORMAT="%U %S"; exec 3>&2; time "$@" >>"$0.log" 2>&1' "$work/build" "$@" 2>&1) || {
    tail -n 20 "$work/build.log" >&2
    exit 1
  }
  awk '{ print $1 + $2 }' <<<"$times"
}

printf '%-6s %-10s %14s %14s\n' run commit programs 'make test'
for ((run = 1; run <= runs; ++run)); do
  for side in base here; do
    rm -rf "$work/$side/build"
    cmake --preset release -S "$work/$side" >/dev/null
    programs=$(seconds_of ninja -C "$work/$side/build/release" -j "$jobs" bin/curvereg bin/curvereg-server)
    rest=$(seconds_of ninja -C "$work/$side/build/release" -j "$jobs")
    printf '%-6s %-10s %12.0f s %12.0f s\n' "$run" "$(git -C "$work/$side" rev-parse --short HEAD)" "$programs" \
      "$(awk -v a="$programs" -v b="$rest" 'BEGIN { print a + b }')"
    echo "$side $programs $rest" >>"$work/figures"
  done
done
awk '{ programs[$1] += $2; all[$1] += $2 + $3 }
  END { printf "ratio             %14.2f %14.2f\n", programs["here"] / programs["base"], all["here"] / all["base"] }' \
  "$work/figures"
