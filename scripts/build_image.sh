#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the container image of docker/Dockerfile with the first that works of docker, buildah and podman.
#
# Docker keeps the image in its own store. For buildah and podman, storage and settings live in STORE, so that the
# machine's own stay as they are, and the image is saved to STORE/curvereg.tar, which `docker load -i` and
# `podman load -i` take. STORE/environment, sourced, makes podman and buildah work on STORE.
#
# usage: build_image.sh [--engine docker|buildah|podman] [--tag NAME] [--store DIR] [--base IMAGE] [--bootstrap-base]
#                       [--fresh] [--jobs N] [--no-save]
#   --tag NAME          default: curvereg:latest
#   --store DIR         default: build/image
#   --base IMAGE        default: debian:bookworm-slim, pulled unless it is there
#   --bootstrap-base    make the base image from Debian's packages; also done when it cannot be pulled. Needs root and
#                       debootstrap
#   --fresh             pull or make the base anew and use no layer of an earlier build: takes Debian's updates in
#   --jobs N            parallel compilations; default: one per processor
#   --no-save           no STORE/curvereg.tar
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PATH=$PATH:/usr/sbin:/sbin

engine=
tag=curvereg:latest
store=build/image
base=debian:bookworm-slim
bootstrap=no
fresh=no
jobs=
save=yes

die() {
  echo "build_image.sh: $*" >&2
  exit 1
}

while [ $# -gt 0 ]; do
  case $1 in
    --engine | --tag | --store | --base | --jobs)
      [ $# -ge 2 ] || die "$1 needs a value"
      printf -v "${1#--}" '%s' "$2"
      shift 2
      ;;
    --bootstrap-base) bootstrap=yes && shift ;;
    --fresh) fresh=yes && shift ;;
    --no-save) save=no && shift ;;
    *) die "unknown argument '$1'; see the head of this file" ;;
  esac
done

# A client without an engine behind it does not count.
works() {
  case $1 in
    docker) timeout 10 docker info >/dev/null 2>&1 ;;
    buildah | podman) command -v "$1" >/dev/null && "$1" info >/dev/null 2>&1 ;;
    *) die "unknown engine '$1'" ;;
  esac
}

# Storage and settings of buildah and podman. Both limits are set to what suffices for a build: engines ask for
# more than this process may have, which fails without CAP_SYS_RESOURCE. runc also starts where cgroups are in hybrid mode.
write_settings() {
  mkdir -p "$store"
  store=$(realpath "$store")
  cat >"$store/storage.conf" <<C
[storage]
driver = "${STORAGE_DRIVER:-overlay}"
graphroot = "$store/storage"
runroot = "$store/run"
C
  local files processes
  files=$(ulimit -Hn)
  processes=$(ulimit -Hu)
  [ "$files" != unlimited ] && [ "$files" -lt 16384 ] || files=16384
  [ "$processes" != unlimited ] && [ "$processes" -lt 16384 ] || processes=16384
  {
    printf '[containers]\ndefault_ulimits = ["nofile=%s:%s", "nproc=%s:%s"]\nnetns = "host"\n' \
      "$files" "$files" "$processes" "$processes"
    printf '[engine]\ncgroup_manager = "cgroupfs"\nevents_logger = "file"\n'
    if command -v runc >/dev/null; then echo 'runtime = "runc"'; fi
  } >"$store/containers.conf"
  printf 'export CONTAINERS_STORAGE_CONF=%q CONTAINERS_CONF=%q\n' "$store/storage.conf" "$store/containers.conf" \
    >"$store/environment"
  # shellcheck disable=SC1091
  . "$store/environment"
}

# One that need not be made anew.
have_image() { [ "$fresh" = no ] && "$engine" inspect --type image "$1" >/dev/null 2>&1; }

import_base() {  # import_base TAR NAME
  case $engine in
    docker | podman) "$engine" import -c 'CMD ["bash"]' "$1" "$2" ;;
    buildah)
      local container
      container=$(buildah from scratch)
      buildah add -q "$container" "$1" /
      buildah config --cmd bash "$container"
      buildah commit -q "$container" "$2"
      buildah rm "$container"
      ;;
  esac >/dev/null
}

# A minimal Debian as the published one: without documents other than licences, package lists, caches.
bootstrap_base() {  # bootstrap_base NAME
  [ "$(id -u)" -eq 0 ] || die "making a base image needs root; or pull $base beforehand"
  command -v debootstrap >/dev/null || die "making a base image needs debootstrap (apt-get install debootstrap)"
  local work root
  work=$(mktemp -d)
  # shellcheck disable=SC2064
  trap "rm -rf '$work'" EXIT
  root=$work/root
  echo "build_image.sh: making $1 from Debian's packages"
  mkdir -p "$root/etc/dpkg/dpkg.cfg.d"
  cat >"$root/etc/dpkg/dpkg.cfg.d/slim" <<'C'
path-exclude /usr/share/doc/*
path-include /usr/share/doc/*/copyright
path-exclude /usr/share/man/*
path-exclude /usr/share/info/*
path-exclude /usr/share/locale/*
C
  debootstrap --variant=minbase bookworm "$root" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; die 'debootstrap failed'; }
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"
  chmod 755 "$root/usr/sbin/policy-rc.d"
  cat >"$root/etc/apt/apt.conf.d/slim" <<'C'
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
Acquire::GzipIndexes "true";
Acquire::Languages "none";
DPkg::Post-Invoke { "rm -f /var/cache/apt/archives/*.deb || true"; };
C
  cat >"$root/etc/apt/sources.list" <<'C'
deb http://deb.debian.org/debian bookworm main
deb http://deb.debian.org/debian bookworm-updates main
deb http://deb.debian.org/debian-security bookworm-security main
C
  {
    chroot "$root" apt-get update -q &&
      DEBIAN_FRONTEND=noninteractive chroot "$root" apt-get upgrade -q -y --no-install-recommends
  } >>"$work/log" 2>&1 </dev/null || { tail -n 20 "$work/log" >&2; die 'updating the base failed'; }
  find "$root/usr/share/doc" -type f ! -name copyright -delete
  rm -rf "$root"/usr/share/{man,info,locale}/* "$root"/var/lib/apt/lists/* "$root"/var/cache/apt/* \
    "$root"/var/log/* "${root:?}"/dev/* "$root/etc/resolv.conf" "$root/etc/hostname"
  tar --numeric-owner -C "$root" -cf "$work/base.tar" .
  import_base "$work/base.tar" "$1"
}

ensure_base() {
  local own=localhost/curvereg-base:bookworm
  if [ "$bootstrap" = no ]; then
    if have_image "$base" || timeout 300 "$engine" pull "$base"; then return; fi
    echo "build_image.sh: $base cannot be pulled" >&2
  fi
  base=$own
  have_image "$base" || bootstrap_base "$base"
}

build() {
  local revision arguments
  revision=$(git rev-parse HEAD 2>/dev/null || echo unknown)
  [ -z "$(git status --porcelain --untracked-files=no 2>/dev/null)" ] || revision=$revision-modified
  arguments=(-f docker/Dockerfile -t "$tag" --network host --build-arg "BASE_IMAGE=$base" --build-arg "JOBS=$jobs"
    --build-arg "VERSION=$(sed -nE 's/^ *VERSION ([0-9.]+)$/\1/p' CMakeLists.txt)" --build-arg "REVISION=$revision")
  [ "$fresh" = no ] || arguments+=(--no-cache)
  case $engine in
    docker) DOCKER_BUILDKIT=1 docker build "${arguments[@]}" . ;;
    # The health check is Docker's format only.
    buildah | podman) "$engine" build --pull-never --layers --format docker "${arguments[@]}" . ;;
  esac
}

save_image() {
  rm -f "$store/curvereg.tar"
  case $engine in
    podman) podman save -q --format docker-archive -o "$store/curvereg.tar" "$tag" ;;
    buildah) buildah push -q "$tag" "docker-archive:$store/curvereg.tar:$tag" ;;
  esac
  echo "build_image.sh: saved to $store/curvereg.tar"
}

# Docker is asked before STORE is made: its image goes into its own store.
if [ -z "$engine" ] && works docker; then engine=docker; fi
[ "$engine" != docker ] || works docker || die 'docker has no running engine here'
if [ "$engine" != docker ]; then
  write_settings
  for candidate in ${engine:-buildah podman}; do
    if works "$candidate"; then engine=$candidate && break; fi
    [ "$candidate" != "$engine" ] || die "$engine does not work here: $("$engine" info 2>&1 | tail -n 1)"
  done
fi
[ -n "$engine" ] || die 'needs docker (with a running engine), buildah or podman; on Debian: apt-get install buildah runc'
echo "build_image.sh: building $tag with $engine"
ensure_base
build
if [ "$engine" != docker ]; then
  [ "$save" = no ] || save_image
fi
"$engine" images | grep -E "REPOSITORY|(^|/)${tag%%:*} "
