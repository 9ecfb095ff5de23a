#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# The quick checks of everything that git tracks: format, licence lines, machine paths, documents, layout, folder
# arrows, hidden state.
# Each check prints what is wrong as FILE: REASON (or FILE:LINE:TEXT); the exit status is 1 when any check found something.
# shellcheck disable=SC2317  # the checks are called by name
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2

failed=0
check() {  # check TITLE FUNCTION: the function prints findings, nothing when all is well
  local findings
  findings=$("$2" 2>&1)
  if [ -z "$findings" ]; then
    printf 'ok    %s\n' "$1"
  else
    printf 'WRONG %s\n%s\n' "$1" "      ${findings//$'\n'/$'\n'      }"
    failed=1
  fi
}
tracked() { git ls-files --deduplicate -- "$@" | while read -r file; do [ -f "$file" ] && printf '%s\n' "$file"; done; }

format() {
  # Version 14 is Debian 12's: other versions format differently.
  tracked '*.h' '*.cc' | xargs -r clang-format-14 --dry-run -Werror 2>&1 | grep -E 'error:|command not found' |
    cut -d: -f1 | sort | uniq -c | awk '{print $2 ": " $1 " places differ; run make format"}'
}

licence_lines() {
  local file
  tracked '*.h' '*.cc' '*.py' '*.sh' '*.cmake' '*CMakeLists.txt' Makefile .ci/run '*.proto' | grep -v '^proto/google/' | while read -r file; do
    [ "$(head -n 3 "$file" | grep -c 'SPDX-')" -eq 2 ] || echo "$file: lacks the two SPDX lines"
  done
}

machine_paths() {
  tracked | grep -v '^LICENSE$' | xargs -r grep -nIE "(^|[^A-Za-z0-9_.}])/(wo[r]k|ho[m]e|ro[o]t|t[m]p)/" | cut -c1-160
}

documents() {  # every `folder/file` and (link) that a document names must be there
  local document name folders
  folders=$(tracked | grep -o '^[^/]*/' | sort -u | tr -d '/' | sed 's/\./\\./g' | paste -sd '|')
  tracked '*.md' | while read -r document; do
    # shellcheck disable=SC2016
    grep -oE "\`($folders)/[A-Za-z0-9_./-]+\`" "$document" | tr -d '`' |
      sort -u | while read -r name; do
        [ -e "$name" ] || compgen -G "$name.*" >/dev/null || [[ $name == *NAME* ]] || echo "$document: names $name, which is not there"
      done
    grep -oE '\]\([^)#]+' "$document" | sed 's/^](//' | grep -vE '^[a-z]+:' | sort -u | while read -r name; do
      [ -e "$(dirname "$document")/$name" ] || echo "$document: links to $name, which is not there"
    done
  done
}

# Programs, and files that a test of another name covers, say so in this table: SOURCE TEST, both must be there.
TESTED_ELSEWHERE=scripts/tested_elsewhere.txt

tests_mirror_sources() {
  local file test name folder
  tracked '*.cc' | grep -vE '^(tests|bench|fuzz|examples|cmake)/' | while read -r file; do
    test=tests/${file%.cc}_test.cc
    [ -f "$test" ] || grep -qE "^$file " "$TESTED_ELSEWHERE" || echo "$file: has no $test and no line in $TESTED_ELSEWHERE"
  done
  grep -vE '^(#|$)' "$TESTED_ELSEWHERE" | while read -r file test; do
    [ -f "$file" ] || echo "$TESTED_ELSEWHERE: $file is not there"
    [ -f "$test" ] || echo "$TESTED_ELSEWHERE: $test is not there"
    [ ! -f "tests/${file%.cc}_test.cc" ] || echo "$TESTED_ELSEWHERE: $file has a test of its own name"
  done
  tracked 'tests/*_test.cc' | while read -r file; do
    name=$(basename "$file" _test.cc)
    folder=$(dirname "${file#tests/}")
    awk -v folder="$folder" -v name="$name" '
      /curvereg_add_tests\(/ { inside = ($0 ~ "curvereg_add_tests\\(" folder "[ )]" || $0 ~ "curvereg_add_tests\\(" folder "$") }
      inside && $0 ~ "(^|[ (])" name "([ )]|$)" { found = 1 }
      /\)/ { inside = 0 }
      END { exit !found }' tests/CMakeLists.txt || echo "$file: is not registered in tests/CMakeLists.txt"
  done
}

folder_arrows() { python3 scripts/check_arrows.py; }

hidden_state() {  # state that outlives a call: mutable statics and thread-locals
  # The exceptions: in core/base/parallel.cc a thread remembers the limit it runs under; core/curvelet/fft.cc holds the
  # lock of FFTW's planner and the plans, which every call shares and none can tell apart; gRPC's log hook in
  # server/operations/grpc_log.cc is a plain function. Fuzzers keep a service from one input to the next.
  tracked '*.h' '*.cc' | grep -vE '^(core/base/parallel|core/curvelet/fft|server/operations/grpc_log)\.cc$|^(fuzz|tests)/' |
    xargs -r grep -nE '^\s*(inline )?(static|thread_local) ([^(]*(=|;)|.*\bthread_local\b)' |
    grep -vE 'static (inline )?(const|constexpr)\b'
}

long_files() {  # a source is read in one sitting
  tracked '*.h' '*.cc' | while read -r file; do
    [ "$(wc -l <"$file")" -le 400 ] || echo "$file: has more than 400 lines"
  done | grep -v '^tests/'
}

large_files() {
  local file
  tracked | while read -r file; do
    [ "$(stat -c %s "$file")" -le 1000000 ] || echo "$file: larger than 1 MB"
  done
}

if [ -z "$(git ls-files 2>/dev/null | head -n 1)" ]; then
  echo 'lint.sh: needs a git clone' >&2
  exit 2
fi
command -v clang-format-14 >/dev/null || { echo 'lint.sh: clang-format-14 is missing; run make lint' >&2; exit 2; }

check 'format (clang-format 14)' format
check 'licence lines' licence_lines
check 'no path of one machine' machine_paths
check 'documents name files that are there' documents
check 'tests mirror the sources' tests_mirror_sources
check 'folders include only what lies below' folder_arrows
check 'no long files' long_files
check 'no hidden state' hidden_state
check 'no large files' large_files
exit $failed
