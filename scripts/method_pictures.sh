#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Draws the pictures of docs/method.md with the project's own commands, and prints the figures next to them.
# About a minute.
#
# usage: method_pictures.sh [PICTURES_DIR [OUT_DIR]]      default: docs/pictures out/pictures; CURVEREG names another
# executable
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
curvereg=${CURVEREG:-build/release/bin/curvereg}
pictures=${1:-docs/pictures}
out=${2:-out/pictures}
python=/usr/bin/python3 # Debian's, which finds what python3-matplotlib brings

run() {
  printf '$ %s\n' "$*"
  "$@"
}

# keep PICTURE NAME: the same picture in all its colours; in 256 of them when it would have 400 kB or more. A palette draws
# bands into even greys. MAXCOVERAGE: no colour is far from its own.
keep() {
  "$python" -c '
import os, sys
from PIL import Image
picture = Image.open(sys.argv[1]).convert("RGB")
picture.save(sys.argv[2], optimize=True)
if os.path.getsize(sys.argv[2]) >= 400_000:
    picture.quantize(256, method=Image.MAXCOVERAGE).save(sys.argv[2], optimize=True)' "$1" "$pictures/$2.png"
}

# embedded PAGE NUMBER: the picture of that number in a page that has its pictures inside.
embedded() { grep -o 'base64,[^"]*' "$1" | sed -n "$2s/^base64,//p" | base64 -d; }

if [ ! -x "$curvereg" ]; then
  echo "method_pictures.sh: $curvereg is not there; run 'make pictures' or 'make build' first" >&2
  exit 1
fi
rm -rf "$out"
mkdir -p "$out" "$pictures"

# One scan.
run "$curvereg" simulate --preset mars-yard-sim --out "$out/yard"
run "$curvereg" inspect "$out/yard/0010.pcd" --out "$out/inspect"
keep "$out/inspect/elevation_doc_4.png" curvelets
keep "$out/inspect/elevation_keypoints.png" keypoints

# Two scans with different heading; and the errors of a method that starts from the identity beside those of curvelet.
run "$curvereg" simulate --preset random-yaw --scans 14 --out "$out/turned"
run "$curvereg" register "$out/turned/0004.pcd" "$out/turned/0002.pcd" --report "$out/pair"
embedded "$out/pair/report.html" 3 >"$out/given.png"
embedded "$out/pair/report.html" 1 >"$out/registered.png"
keep "$out/given.png" pair_given
keep "$out/registered.png" pair_registered
run "$curvereg" evaluate "$out/turned" --method curvelet,icp --every 2 --out "$out/pairs"
keep "$out/pairs/figure_1_errors.png" errors

# A whole drive.
run "$curvereg" stream "$out/yard" --traverse yard --optimize --data-dir "$out/data" >"$out/stream.txt"
tail -n 2 "$out/stream.txt"
run "$curvereg" traverse report yard --out "$out/traverse" --data-dir "$out/data"
keep "$out/traverse/figure_1_trajectory.png" trajectory
run "$curvereg" evaluate "$out/yard" --mode traverse --out "$out/drive"
keep "$out/drive/figure_5_drift.png" drift
keep "$out/drive/figure_4_map_optimised.png" map

printf '\nDrawn:\n'
du -b "$pictures"/*.png
