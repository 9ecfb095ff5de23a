#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the container image, runs it as it is meant to be run, and registers two simulated scans through it.
#
# Skipped (status 77) unless this is root with podman, runc and debootstrap; CURVEREG_TEST_IMAGE=1 makes lacking them a
# failure, CURVEREG_TEST_IMAGE=0 skips in any case. The first build takes minutes, later ones find unchanged layers in
# STORE. CURVEREG_IMAGE_JOBS: parallel compilations within the build.
#
# usage: image_test.sh CURVEREG_EXECUTABLE STORE
set -euo pipefail
export PATH=$PATH:/usr/sbin:/sbin
curvereg=$1
store=$2
max_image_bytes=160000000

skip() {
  echo "SKIPPED: the container image was not tested: $*" >&2
  exit 77
}
lacking() {
  [ "${CURVEREG_TEST_IMAGE:-}" != 1 ] || { echo "FAILED: CURVEREG_TEST_IMAGE=1, but $*" >&2; exit 1; }
  skip "$*"
}
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
step() { echo "-- $*"; }

[ "${CURVEREG_TEST_IMAGE:-}" != 0 ] || skip 'CURVEREG_TEST_IMAGE is 0'
[ "$(id -u)" -eq 0 ] || lacking 'this is not root'
for tool in podman runc debootstrap; do
  command -v "$tool" >/dev/null || lacking "$tool is not installed (apt-get install buildah podman runc debootstrap)"
done

work=$(mktemp -d)
container=curvereg-image-test-$$
cleanup() {
  podman rm -f -v -t 0 "$container" >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap cleanup EXIT

# ---- build ----------------------------------------------------------------------------------------------------------
step 'build'
engine=podman
if command -v buildah >/dev/null; then engine=buildah; fi
if ! nice -n 19 "$(dirname "$0")/../../scripts/build_image.sh" --engine $engine --store "$store" --bootstrap-base \
  --tag localhost/curvereg:test --jobs "${CURVEREG_IMAGE_JOBS:-$(nproc)}" --no-save >"$work/build.log" 2>&1 </dev/null; then
  tail -n 40 "$work/build.log" >&2
  timeout 20 bash -c 'exec 3<>/dev/tcp/deb.debian.org/80' 2>/dev/null || lacking 'there is no network'
  fail 'the image cannot be built'
fi
# shellcheck disable=SC1091
. "$store/environment"
image=localhost/curvereg:test
of_image() { podman image inspect -f "$1" $image; }

step 'what the image is'
size=$(of_image '{{.Size}}')
echo "   $size bytes"
[ "$size" -lt $max_image_bytes ] || fail "the image has $size bytes, allowed are $max_image_bytes"
[ "$(of_image '{{.Config.User}}')" = 10001:10001 ] || fail 'the user is not 10001'
[ "$(of_image '{{.Config.StopSignal}}')" = SIGTERM ] || fail 'the stop signal is not SIGTERM'
[ "$(of_image '{{.Config.Healthcheck.Test}}')" = '[CMD curvereg status]' ] || fail 'the health check is another'
[ "$(of_image '{{len .Config.Volumes}}')" = 1 ] || fail 'not one volume'
in_image() { podman run --rm --no-healthcheck --network none --entrypoint bash $image -c "$1"; }
in_image '! command -v gcc g++ c++ cc ld cmake ninja make git' || fail 'there are build tools in the image'
in_image '! ls /usr/lib/*/ | grep -iE "vtk|libpcl|mpi"' || fail 'there are PCL, VTK or MPI in the image'
in_image '! ldd /usr/local/bin/curvereg /usr/local/bin/curvereg-server | grep "not found"' || fail 'a library is missing'

step 'plain text off loopback must be asked for'
if podman run --rm --no-healthcheck --network none --read-only --cap-drop ALL $image >"$work/refused" 2>&1; then
  fail 'the server starts in plain text on all addresses'
fi
grep -qi 'plain' "$work/refused" || fail "the refusal does not say why: $(cat "$work/refused")"

# ---- run ------------------------------------------------------------------------------------------------------------
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 10000))
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || { echo $port && return; }
  done
}
port=$(free_port)
ops_port=$((port + 1))
step "run on 127.0.0.1:$port"
podman run -d --name "$container" --network host --read-only --read-only-tmpfs=false --cap-drop ALL \
  --security-opt no-new-privileges --memory 2g --pids-limit 512 \
  -e CURVEREG_SERVER_LISTEN="127.0.0.1:$port" -e CURVEREG_SERVER_OPS_LISTEN="127.0.0.1:$ops_port" \
  -e CURVEREG_SERVER="127.0.0.1:$port" $image >/dev/null 2>"$work/run.log" || fail "cannot run: $(cat "$work/run.log")"
healthy=no
for _ in $(seq 60); do
  if podman exec "$container" curvereg status >"$work/status" 2>&1; then healthy=yes && break; fi
  [ "$(podman inspect -f '{{.State.Running}}' "$container")" = true ] || break
  sleep 1
done
[ $healthy = yes ] || fail "not healthy in 60 s: $(cat "$work/status"); $(podman logs "$container" 2>&1 | tail -n 20)"
podman healthcheck run "$container" || fail 'the health check fails'

step 'user, capabilities, read-only root'
[ "$(podman exec "$container" id -u)" = 10001 ] || fail 'does not run as user 10001'
podman exec "$container" grep -E '^(Uid|CapEff|NoNewPrivs|Seccomp):' /proc/1/status | tr -s '\t\n' ' ' | tee "$work/process"
grep -q 'Uid: 10001 10001 10001 10001 CapEff: 0000000000000000 NoNewPrivs: 1 Seccomp: 2' "$work/process" ||
  fail 'the process has more rights than it needs'
! podman exec "$container" touch /usr/local/touched 2>/dev/null || fail 'the root file system can be written'
podman exec --user 0 "$container" grep -qE '^[^ ]+ / [^ ]+ ro[, ]' /proc/mounts || fail 'the root is not mounted read-only'
podman exec "$container" bash -c '[ -n "$(ls -A /var/lib/curvereg)" ]' || fail 'nothing is in the data volume'

step 'two scans through it'
"$curvereg" simulate --preset sparse --scans 2 --out "$work/scans" >/dev/null
"$curvereg" register --json "$work/scans/0001.pcd" "$work/scans/0000.pcd" --server "127.0.0.1:$port" >"$work/remote.json" ||
  fail "register ends with status $?: $(cat "$work/remote.json")"
env -u CURVEREG_SERVER "$curvereg" register --json "$work/scans/0001.pcd" "$work/scans/0000.pcd" >"$work/local.json"
python3 - "$work" <<'P' || fail 'the transform is wrong'
import json, math, sys
remote, local = (json.load(open(f"{sys.argv[1]}/{name}.json")) for name in ("remote", "local"))
poses = [list(map(float, line.split()))[1:] for line in open(f"{sys.argv[1]}/scans/poses.txt") if line[0] != "#"]

def rotate_back(q, v):  # R(q)^T v
    x, y, z, w = -q[0], -q[1], -q[2], q[3]
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]

truth = rotate_back(poses[0][3:], [s - t for s, t in zip(poses[1][:3], poses[0][:3])])
found = [row[3] for row in remote["T_target_source"][:3]]
error_m = math.dist(truth, found)
print(f"   accepted {remote['accepted']}, off the truth by {error_m * 1e3:.1f} mm, as in one process:",
      remote["T_target_source"] == local["T_target_source"])
sys.exit(0 if remote["accepted"] and error_m < 0.05 and remote["T_target_source"] == local["T_target_source"] else 1)
P
exec 3<>"/dev/tcp/127.0.0.1/$ops_port"
printf 'GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n' >&3
timeout 10 cat <&3 | grep -qE '^grpc_server_handled_total\{.*RegisterScans.*\} 1' || fail 'the metrics do not count the call'
exec 3>&-

step 'SIGTERM'
podman stop -t 40 "$container" >/dev/null
status=$(podman inspect -f '{{.State.ExitCode}}' "$container")
[ "$status" = 0 ] || fail "exit status $status on SIGTERM; $(podman logs "$container" 2>&1 | tail -n 20)"
echo 'PASSED'
