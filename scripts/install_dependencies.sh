#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Debian 12 packages that are missing, and nothing else. Asks nothing; needs root or sudo only when
# something is missing.
#
# usage: install_dependencies.sh [GROUP...]      default: build server baselines plots
set -euo pipefail

# ---- what is needed -------------------------------------------------------------------------------------------------
declare -A PACKAGES=(
  # compiler, build tools, and the libraries of core, client, sim, eval and their tests; no gRPC, no PCL
  [build]="
    g++ gcc libc6-dev cmake ninja-build ccache make git pkg-config python3
    libeigen3-dev libfftw3-dev libflann-dev liblz4-dev libabsl-dev libtbb-dev libxxhash-dev
    libpng-dev libceres-dev libcli11-dev nlohmann-json3-dev zlib1g-dev
    libopencv-core-dev libopencv-imgproc-dev
    libgtest-dev libgmock-dev libbenchmark-dev"
  # the service and its client library (-DCURVEREG_BUILD_SERVER=OFF does without), and what their tests call
  [server]="
    libgrpc++-dev libgrpc-dev protobuf-compiler-grpc libprotobuf-dev protobuf-compiler grpc-proto
    libssl-dev libsqlite3-dev libzstd-dev libisal-dev libspdlog-dev prometheus-cpp-dev libcivetweb-dev
    libtomlplusplus-dev
    openssl prometheus python3 python3-grpcio python3-protobuf"
  # what the built executables load, without the paper's baselines: the container image has these and nothing else of ours
  # (OpenCV is part of the executables; LAPACK and BLAS, which it asks for, come with libceres3)
  [runtime]="
    libstdc++6 libgrpc++1.51 libgrpc29 libprotobuf32 libabsl20220623 libssl3 libsqlite3-0 libzstd1 libisal2
    libspdlog1.10 libtomlplusplus3 libprometheus-cpp-core1.0 libcivetweb1
    libceres3 libfftw3-double3 libfftw3-single3 libtbb12 libxxhash0 liblz4-1 libpng16-16 zlib1g"
  # the paper's baselines (-DCURVEREG_BUILD_BASELINES=OFF does without; by far the largest download)
  [baselines]="libpcl-dev"
  # the figures of the evaluation report
  [plots]="python3 python3-matplotlib"
  # for developers
  [format]="clang-format-14 clang-format git python3"
  [lint]="clang-tidy-14 clang-tidy clang-14 python3"
  [fuzz]="clang-14 clang libclang-rt-14-dev"
)
# ---------------------------------------------------------------------------------------------------------------------

groups=("$@")
[ ${#groups[@]} -gt 0 ] || groups=(build server baselines plots)

missing=()
for group in "${groups[@]}"; do
  if [ -z "${PACKAGES[$group]:-}" ]; then
    echo "install_dependencies.sh: no group '$group'; groups: ${!PACKAGES[*]}" >&2
    exit 2
  fi
  for package in ${PACKAGES[$group]}; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
  done
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "dependencies: nothing is missing (${groups[*]})"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install_dependencies.sh: run as root, or install sudo; missing: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 -o Dpkg::Use-Pty=0 "$@" </dev/null
}

echo "dependencies: installing ${missing[*]}"
apt update -q
apt install -y -q --no-install-recommends "${missing[@]}"
echo "dependencies: installed ${#missing[@]} packages and what they need"
