#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# clang-tidy (.clang-tidy: naming, long functions and likely bugs) on the sources that differ from a commit, or on all of
# them. Exit status 1 when it warns of something.
#
# usage: tidy.sh BUILD_DIR [BASE_COMMIT]      BUILD_DIR holds compile_commands.json
#
# TIDY_SECONDS: stops after so many seconds (default: none) and says how many sources it did not look at. Those that
# changed last come first.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$1
base=${2:-}
seconds=${TIDY_SECONDS:-0}
if [ -n "$base" ]; then
  # --find-renames: a file that only moved is not looked at again.
  mapfile -t changed < <(git diff --find-renames=95% --name-status --diff-filter=AMR "$base" -- '*.cc' |
    awk '$1 != "R100" { print $NF }')
else
  mapfile -t changed < <(git ls-files '*.cc')
fi
# Sources that this build does not compile, such as those of the fuzzers and of the examples, have no command.
files=()
for file in "${changed[@]}"; do
  if grep -qF "\"$PWD/$file\"" "$build/compile_commands.json"; then files+=("$file"); fi
done
[ ${#files[@]} -gt 0 ] || { echo 'tidy: nothing to check'; exit 0; }
mapfile -t files < <(for file in "${files[@]}"; do git log -1 --format="%ct $file" -- "$file"; done | sort -rn | cut -d' ' -f2-)

# GCC's precompiled headers mean nothing to clang: the plain header that CMake writes beside them is used instead.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed -E 's/-Winvalid-pch//g; s/-fpch-preprocess//g; s/-include [^ ]*cmake_pch\.hxx//g' "$build/compile_commands.json" \
  >"$work/compile_commands.json"
end=$(($(date +%s) + seconds))
check_one() {
  if [ "$seconds" -gt 0 ] && [ "$(date +%s)" -ge "$end" ]; then
    echo "$1" >>"$work/skipped"
    return
  fi
  clang-tidy-14 --quiet -p "$work" "$1" 2>/dev/null
}
export -f check_one
export seconds end work
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -I '{}' bash -c 'check_one "$1"' _ '{}' | tee "$work/findings"
skipped=0
[ ! -f "$work/skipped" ] || skipped=$(wc -l <"$work/skipped")
warnings=$(grep -cE '(warning|error): .*\[' "$work/findings" || true)
printf 'tidy: %d sources checked, %d not checked within the time limit, %d findings\n' $((${#files[@]} - skipped)) \
  "$skipped" "$warnings"
[ "$warnings" -eq 0 ]
