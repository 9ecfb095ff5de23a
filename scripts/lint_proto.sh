#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# buf lint (STANDARD and COMMENTS, see proto/buf.yaml) on the contract. Prints FILE:LINE:COLUMN:REASON of what is wrong;
# exit status 100 then, 77 where node or npm is missing, said aloud.
#
# usage: lint_proto.sh [FOLDER]    FOLDER keeps the Node packages; out/node unless given
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=${1:-$root/out/node}
"$root/scripts/install_node_packages.sh" "$folder"
folder=$(cd "$folder" && pwd)
cd "$root/proto"
"$folder/node_modules/.bin/buf" lint
echo "proto: buf $("$folder/node_modules/.bin/buf" --version 2>&1) lint finds nothing"
