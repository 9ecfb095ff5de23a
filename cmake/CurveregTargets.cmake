# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# curvereg_configure(TARGET): language level, warnings and sanitizers of every target of ours.
option(CURVEREG_WERROR "Treat warnings as errors" OFF)
set(CURVEREG_SANITIZER "" CACHE STRING "Value of -fsanitize= for our targets; empty for none")

function(curvereg_configure target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${CURVEREG_WERROR}>:-Werror>)
  # Allowed because no code of ours reads errno after <cmath> or traps on floating point; results stay IEEE. Without
  # fused products every instruction set that core/base/simd.h may pick gives the same bytes.
  target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math
                         -ffp-contract=off)
  # -pthread: gRPC's users get it, so that all get it, for a precompiled header must be compiled as its users are.
  # -fpch-preprocess: lets ccache keep what was compiled with one.
  target_compile_options(${target} PRIVATE -pthread $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  if(CURVEREG_SANITIZER)
    target_compile_options(${target} PRIVATE -fsanitize=${CURVEREG_SANITIZER} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${CURVEREG_SANITIZER})
    target_compile_definitions(${target} PRIVATE CURVEREG_SANITIZED=1)
  endif()
endfunction()

# curvereg_add_library(core FILES...): static library curvereg_core with the alias curvereg::core.
function(curvereg_add_library name)
  add_library(curvereg_${name} STATIC ${ARGN})
  add_library(curvereg::${name} ALIAS curvereg_${name})
  curvereg_configure(curvereg_${name})
endfunction()

# curvereg_add_precompiled(NAME LIBRARIES ... HEADERS ...): headers that nearly every source of a layer parses, parsed
# once. curvereg_precompile(TARGET NAME) lets a target use them. Sources still include what they use:
# -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without.
function(curvereg_add_precompiled name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;HEADERS" ${ARGN})
  add_library(curvereg_${name}_headers OBJECT "${PROJECT_SOURCE_DIR}/cmake/precompiled.cc")
  curvereg_configure(curvereg_${name}_headers)
  target_link_libraries(curvereg_${name}_headers PRIVATE ${ARG_LIBRARIES})
  target_precompile_headers(curvereg_${name}_headers PRIVATE ${ARG_HEADERS})
endfunction()

function(curvereg_precompile target name)
  target_precompile_headers(${target} REUSE_FROM curvereg_${name}_headers)
endfunction()

# curvereg_add_test(core/scan/scan [LABEL unit|integration|slow] [TIMEOUT SECONDS] [SERIAL] [HEADERS test|rpc_test]
#                   [LIBRARIES curvereg::sim ...]):
# builds tests/core/scan/scan_test.cc into its own executable and registers each of its test cases with CTest.
function(curvereg_add_test path)
  cmake_parse_arguments(ARG "SERIAL" "LABEL;TIMEOUT;HEADERS" "LIBRARIES" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS test)
    if(path MATCHES "^(wire|server|client)/")
      set(ARG_HEADERS rpc_test)
    endif()
  endif()
  if(CURVEREG_SANITIZER)
    math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")
  endif()
  # SERIAL: measures time or memory, so no other test may run beside it.
  set(serial FALSE)
  if(ARG_SERIAL)
    set(serial TRUE)
  endif()
  string(REPLACE "/" "_" name "${path}_test")
  add_executable(${name} "${PROJECT_SOURCE_DIR}/tests/${path}_test.cc")
  curvereg_configure(${name})
  target_link_libraries(${name} PRIVATE curvereg::core curvereg_testing GTest::gmock GTest::gtest_main ${ARG_LIBRARIES})
  curvereg_precompile(${name} ${ARG_HEADERS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  gtest_discover_tests(
    ${name}
    TEST_PREFIX "${path}:"
    DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${ARG_TIMEOUT} RUN_SERIAL ${serial}
               ENVIRONMENT_MODIFICATION
               "TSAN_OPTIONS=string_append: suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp")
endfunction()

# curvereg_add_tests(core/scan [options of curvereg_add_test] TESTS scan voxel_map ...): the tests of one folder.
function(curvereg_add_tests folder)
  cmake_parse_arguments(ARG "SERIAL" "LABEL;TIMEOUT;HEADERS" "LIBRARIES;TESTS" ${ARGN})
  set(options LIBRARIES ${ARG_LIBRARIES})
  if(ARG_SERIAL)
    list(PREPEND options SERIAL)
  endif()
  foreach(option LABEL TIMEOUT HEADERS)
    if(ARG_${option})
      list(PREPEND options ${option} ${ARG_${option}})
    endif()
  endforeach()
  foreach(test ${ARG_TESTS})
    curvereg_add_test(${folder}/${test} ${options})
  endforeach()
endfunction()

# curvereg_add_benchmark(scale_bands [LIBRARIES ...]): builds bench/scale_bands_bench.cc.
function(curvereg_add_benchmark name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  add_executable(${name}_bench "${PROJECT_SOURCE_DIR}/bench/${name}_bench.cc")
  curvereg_configure(${name}_bench)
  target_link_libraries(${name}_bench PRIVATE curvereg::core benchmark::benchmark ${ARG_LIBRARIES})
  set_target_properties(${name}_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bench")
endfunction()
