#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# What scripts/build_image.sh asks of an engine that has everything from an earlier build: with --fresh the base comes
# anew and no layer is used again.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# An engine that only writes down what it is asked.
cat >"$work/engine" <<'E2'
#!/bin/sh
echo "$*" >>"$ASKED"
[ "$1" != images ] || echo 'localhost/curvereg latest'
E2
chmod 755 "$work/engine"
for engine in docker buildah podman; do ln -s engine "$work/$engine"; done

fail() {
  echo "FAILED: $engine $*: $(cat "$ASKED")" >&2
  exit 1
}
for engine in docker buildah podman; do
  for fresh in '' --fresh; do
    export ASKED=$work/asked
    rm -f "$ASKED"
    # shellcheck disable=SC2086
    PATH=$work:$PATH scripts/build_image.sh --engine $engine --store "$work/store" --no-save $fresh >/dev/null
    grep -q '^build .*BASE_IMAGE=debian:bookworm-slim' "$ASKED" || fail 'builds nothing'
    pulls=$(grep -c '^pull debian:bookworm-slim' "$ASKED" || true)
    anew=$(grep -c '^build .*--no-cache' "$ASKED" || true)
    case $fresh in
      --fresh) [ "$pulls $anew" = '1 1' ] || fail '--fresh takes what is old' ;;
      *) [ "$pulls $anew" = '0 0' ] || fail 'makes anew what is there' ;;
    esac
  done
done
