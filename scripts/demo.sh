#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# The whole job on a simulated drive: scans, one registration alone and one through a server, an evaluation with figures,
# pictures of one scan.
#
# usage: demo.sh [OUT_DIR]      default: out/demo; CURVEREG names another executable (curvereg-server lies beside it)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
curvereg=${CURVEREG:-build/release/bin/curvereg}
out=${1:-out/demo}
scans=$out/scans

step_number=0
run() {
  local title=$1 started=$SECONDS
  shift
  step_number=$((step_number + 1))
  printf '\n[%d/7] %s\n      $ %s\n' "$step_number" "$title" "$*"
  local status=0
  "$@" || status=$?
  if [ "$status" -ne 0 ]; then
    echo "demo.sh: the command above ended with exit status $status" >&2
    exit "$status"
  fi
  printf '      %d s\n' $((SECONDS - started))
}

if [ ! -x "$curvereg" ]; then
  echo "demo.sh: $curvereg is not there; run 'make demo' or 'make build' first" >&2
  exit 1
fi
rm -rf "$out"
mkdir -p "$out"
started=$SECONDS

run 'Drive a simulated rover over a Mars yard' "$curvereg" simulate --preset mars-yard-sim --scans 6 --out "$scans"

mapfile -t files < <(find "$scans" -maxdepth 1 -type f \( -name '*.pcd' -o -name '*.ply' -o -name '*.bin' \) | sort)
if [ ${#files[@]} -lt 2 ]; then
  echo "demo.sh: expected scans in $scans, found ${#files[@]}" >&2
  exit 1
fi
run 'Register the second scan on the first' "$curvereg" register "${files[1]}" "${files[0]}"

# A server of its own on free ports of loopback, for as long as this script runs.
"$curvereg-server" --listen 127.0.0.1:0 --ops-listen 127.0.0.1:0 --data-dir "$out/server" --ports-file "$out/ports.json" \
  2>"$out/server.log" &
server_pid=$!
trap 'kill "$server_pid" 2>/dev/null || true' EXIT
for _ in $(seq 100); do
  [ -s "$out/ports.json" ] && break
  sleep 0.1
done
server=127.0.0.1:$(sed -E 's/.*"grpc_port":([0-9]+).*/\1/' "$out/ports.json")
run 'Query the status of a server' "$curvereg" status --server "$server"
run 'Upload two scans to it' "$curvereg" scans upload "${files[0]}" "${files[1]}" --server "$server"
mapfile -t names < <("$curvereg" scans upload "${files[0]}" "${files[1]}" --server "$server" | cut -d' ' -f1)
run 'Register the same scans there, by name' "$curvereg" register "${names[1]}" "${names[0]}" --server "$server"
kill "$server_pid"
wait "$server_pid"
trap - EXIT

run 'Evaluate every pair of the drive against the ground truth' "$curvereg" evaluate "$scans" --method curvelet --out "$out/evaluation"
run 'Draw the processing stages of one scan' "$curvereg" inspect "${files[0]}" --out "$out/inspect"

printf '\nDone in %d s. Look at:\n' $((SECONDS - started))
find "$out" -name 'report.html' -printf '  %p\n'
for folder in "$out/evaluation" "$out/inspect"; do
  printf '  %s: %s pictures\n' "$folder" "$(find "$folder" -name '*.png' | wc -l)"
done
