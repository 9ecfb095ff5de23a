#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# clang-tidy (.clang-tidy: naming and likely bugs) on the sources that differ from a commit, or on all of them.
#
# usage: tidy.sh BUILD_DIR [BASE_COMMIT]      BUILD_DIR holds compile_commands.json
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$1
base=${2:-}
if [ -n "$base" ]; then
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- '*.cc')
else
  mapfile -t files < <(git ls-files '*.cc')
fi
[ ${#files[@]} -gt 0 ] || { echo 'tidy: nothing to check'; exit 0; }
# GCC's precompiled headers mean nothing to clang: the plain header that CMake writes beside them is used instead.
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
sed -E 's/-Winvalid-pch//g; s/-include [^ ]*cmake_pch\.hxx//g' "$build/compile_commands.json" >"$commands/compile_commands.json"
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy-14 --quiet -p "$commands"
