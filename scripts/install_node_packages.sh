#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Node packages of tests/clients, exactly as locked, into FOLDER/node_modules; no-op when they are there.
# Exit status 77, and the reason on standard error, where node or npm is missing or the packages cannot be had.
#
# usage: install_node_packages.sh FOLDER
set -euo pipefail
folder=${1:?usage: install_node_packages.sh FOLDER}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../tests/clients" && pwd)
for program in node npm; do
  command -v "$program" >/dev/null || { echo "SKIPPED: $program is not installed" >&2; exit 77; }
done
mkdir -p "$folder"
cd "$folder"
exec 9>.lock  # tests run side by side
flock 9
if [ -f .installed ] && cmp -s .installed "$source/package-lock.json"; then exit 0; fi
rm -f .installed
cp "$source/package.json" "$source/package-lock.json" "$source/.npmrc" .
if ! npm ci --ignore-scripts >npm.log 2>&1; then
  cat npm.log >&2
  # No network, no registry, or a registry without the package: not the fault of what is tested.
  grep -qE 'code (E4|E5|ENOTFOUND|EAI_AGAIN|ECONN|ETIMEDOUT|ENETUNREACH|ERR_SOCKET)' npm.log || exit 1
  echo "SKIPPED: npm cannot fetch the packages of tests/clients" >&2
  exit 77
fi
cp package-lock.json .installed
