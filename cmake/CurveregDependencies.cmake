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
# FLANN's headers need LZ4 and nothing else; its own pkg-config file would link HDF5 and MPI.
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
add_library(curvereg_flann INTERFACE)
target_include_directories(curvereg_flann SYSTEM INTERFACE "${FLANN_INCLUDE_DIR}")
target_link_libraries(curvereg_flann INTERFACE PkgConfig::LZ4)

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
