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
# Ceres's own CMake package names the static library, which would tie the executables to the LAPACK of the machine that
# built them (ATLAS, with libceres-dev) and to SuiteSparse; the shared one brings what it needs.
find_library(CERES_LIBRARY NAMES libceres.so REQUIRED)
find_path(CERES_INCLUDE_DIR ceres/ceres.h REQUIRED)
pkg_check_modules(GLOG REQUIRED IMPORTED_TARGET libglog)
add_library(curvereg_ceres INTERFACE)
target_include_directories(curvereg_ceres SYSTEM INTERFACE "${CERES_INCLUDE_DIR}")
target_link_libraries(curvereg_ceres INTERFACE "${CERES_LIBRARY}" PkgConfig::GLOG)
pkg_check_modules(FFTW REQUIRED IMPORTED_TARGET fftw3 fftw3f)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
# FLANN's headers need LZ4 and nothing else; its own pkg-config file would link HDF5 and MPI.
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
add_library(curvereg_flann INTERFACE)
target_include_directories(curvereg_flann SYSTEM INTERFACE "${FLANN_INCLUDE_DIR}")
target_link_libraries(curvereg_flann INTERFACE PkgConfig::LZ4)
# OpenCV's core and imgproc. Found by hand: Debian's OpenCVConfig.cmake comes with all modules and asks for all of them.
# Linked from their archives: the shared libopencv_core loads libGLX, whose package brings Mesa and LLVM, more than 200 MB
# (docs/adr/2026-11-30-opencv.md). --gc-sections leaves out what no program calls; sanitizers and fuzzers keep sections
# of their own that it would drop.
find_path(OPENCV_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
find_library(OPENCV_CORE_ARCHIVE NAMES libopencv_core.a REQUIRED)
find_library(OPENCV_IMGPROC_ARCHIVE NAMES libopencv_imgproc.a REQUIRED)
find_package(ZLIB REQUIRED)
find_library(LAPACK_LIBRARY NAMES liblapack.so REQUIRED)
find_library(BLAS_LIBRARY NAMES libblas.so REQUIRED)
add_library(curvereg_opencv_without_opengl STATIC "${CMAKE_CURRENT_LIST_DIR}/opencv_without_opengl.cc")
set_target_properties(curvereg_opencv_without_opengl PROPERTIES POSITION_INDEPENDENT_CODE ON)
add_library(curvereg_opencv INTERFACE)
target_include_directories(curvereg_opencv SYSTEM INTERFACE "${OPENCV_INCLUDE_DIR}")
# Imported targets, for an archive must come before what it needs on every linker's command line.
add_library(curvereg_opencv_core STATIC IMPORTED GLOBAL)
set_target_properties(curvereg_opencv_core PROPERTIES IMPORTED_LOCATION "${OPENCV_CORE_ARCHIVE}")
target_link_libraries(curvereg_opencv_core INTERFACE curvereg_opencv_without_opengl TBB::tbb ZLIB::ZLIB "${LAPACK_LIBRARY}"
                                                     "${BLAS_LIBRARY}" ${CMAKE_DL_LIBS})
add_library(curvereg_opencv_imgproc STATIC IMPORTED GLOBAL)
set_target_properties(curvereg_opencv_imgproc PROPERTIES IMPORTED_LOCATION "${OPENCV_IMGPROC_ARCHIVE}")
target_link_libraries(curvereg_opencv_imgproc INTERFACE curvereg_opencv_core)
target_link_libraries(curvereg_opencv INTERFACE $<BUILD_INTERFACE:curvereg_opencv_imgproc>)
# Users of the installed libraries link the shared ones, which their own code may use, too.
target_link_libraries(curvereg_opencv INTERFACE $<INSTALL_INTERFACE:opencv_imgproc> $<INSTALL_INTERFACE:opencv_core>)
if(NOT CURVEREG_SANITIZER AND NOT CURVEREG_BUILD_FUZZERS)
  target_link_options(curvereg_opencv INTERFACE $<BUILD_INTERFACE:LINKER:--gc-sections>
                      $<BUILD_INTERFACE:LINKER:--as-needed>)
endif()

if(CURVEREG_BUILD_BASELINES)
  # Only these components: the others bring VTK with them.
  find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree search sample_consensus filters features keypoints registration)
endif()
if(CURVEREG_BUILD_SERVER)
  find_package(Protobuf REQUIRED)
  find_package(gRPC REQUIRED CONFIG)
  find_package(OpenSSL 3.0 REQUIRED)
  find_package(SQLite3 3.40 REQUIRED)
  find_package(spdlog REQUIRED)
  find_package(prometheus-cpp REQUIRED CONFIG)
  find_package(civetweb REQUIRED CONFIG)
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
  pkg_check_modules(ISAL REQUIRED IMPORTED_TARGET libisal)
  pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
endif()
if(CURVEREG_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(CURVEREG_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
