# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# Every package that Curvereg is built with, found in one place (Debian 12 packages, see scripts/install_dependencies.sh).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(absl REQUIRED)
find_package(TBB REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(PNG REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(FFTW REQUIRED IMPORTED_TARGET fftw3 fftw3f)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)

if(CURVEREG_BUILD_BASELINES)
  # Only these components: the others bring VTK with them.
  find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree search sample_consensus filters features keypoints registration)
endif()
if(CURVEREG_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(CURVEREG_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
