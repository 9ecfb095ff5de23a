#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs client_test.js with its packages in PACKAGES/node_modules. Exit status 77 where something is missing, said aloud.
#
# usage: run.sh PACKAGES SERVER CURVEREG PROTO_ROOT GRPC_PROTO_ROOT
set -euo pipefail
packages=$1
shift
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$here/../../../scripts/install_node_packages.sh" "$packages"
[ -f "$4/grpc/health/v1/health.proto" ] || { echo "SKIPPED: $4/grpc/health/v1/health.proto is not installed" >&2; exit 77; }
NODE_PATH=$(cd "$packages" && pwd)/node_modules exec node "$here/client_test.js" "$@"
