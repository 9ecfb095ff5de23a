# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# What users of the libraries need, as component "development": static libraries, headers, and the package for
# find_package(curvereg).
#
# All headers lie below include/curvereg, so that PREFIX/include is the only search path and no folder of ours takes a
# name that a user's may have: <curvereg/client.h>, <curvereg/core/register_scans.h>. Our sources include the same files
# as "client/client.h" and "core/register_scans.h"; cmake/InstallHeaders.cmake renames them on the way.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/curvereg")
set(generated_dir "${PROJECT_BINARY_DIR}/proto/generated")

# curvereg_install_component(core LIBRARIES core methods ...): libraries that one component of find_package(curvereg)
# brings. Components have an export of their own, so that each asks only for the packages that it needs; which those
# are is written in cmake/curveregConfig.cmake.in.
function(curvereg_install_component component)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  foreach(name ${ARG_LIBRARIES})
    set_target_properties(curvereg_${name} PROPERTIES EXPORT_NAME ${name})
    set(include_dirs "${CMAKE_INSTALL_INCLUDEDIR}")
    if(name STREQUAL proto)
      list(APPEND include_dirs "${CMAKE_INSTALL_INCLUDEDIR}/curvereg/proto")  # google/rpc, see below
    endif()
    install(
      TARGETS curvereg_${name}
      EXPORT curvereg-${component}
      COMPONENT development
      ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
      INCLUDES
      DESTINATION ${include_dirs})
  endforeach()
  install(
    EXPORT curvereg-${component}
    NAMESPACE curvereg::
    DESTINATION "${package_dir}"
    COMPONENT development)
endfunction()

curvereg_install_component(core LIBRARIES core methods baselines flann opencv)
curvereg_install_component(render LIBRARIES render)
curvereg_install_component(files LIBRARIES files)
if(CURVEREG_BUILD_SERVER)
  curvereg_install_component(client LIBRARIES client wire proto)
endif()

# The baselines are called through RegisterScans; of the mapping, which is not installed, clients need the types.
set(header_code
    "file(GLOB_RECURSE headers RELATIVE \"${PROJECT_SOURCE_DIR}\" \"${PROJECT_SOURCE_DIR}/core/*.h\"
     \"${PROJECT_SOURCE_DIR}/files/*.h\" \"${PROJECT_SOURCE_DIR}/render/*.h\")
list(FILTER headers EXCLUDE REGEX \"^core/(baselines|mapping)/\")
list(APPEND headers client/pcl.h client/pcl_clouds.h client/pcl_registration.h)")
if(CURVEREG_BUILD_SERVER)
  string(APPEND header_code "
file(GLOB wire_headers RELATIVE \"${PROJECT_SOURCE_DIR}\" \"${PROJECT_SOURCE_DIR}/wire/*.h\")
list(APPEND headers client/client.h client/traverse_types.h client/traverses.h core/mapping/trajectory.h \${wire_headers})")
endif()
set(staged_headers "${PROJECT_BINARY_DIR}/installed_headers")
install(
  CODE "${header_code}
set(source_dir \"${PROJECT_SOURCE_DIR}\")
set(generated_dir \"${generated_dir}\")
set(output_dir \"${staged_headers}\")
include(\"${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake\")"
  COMPONENT development)
install(
  DIRECTORY "${staged_headers}/"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  COMPONENT development)

if(CURVEREG_BUILD_SERVER)
  install(
    DIRECTORY "${generated_dir}/curvereg"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    COMPONENT development
    FILES_MATCHING
    PATTERN "*.pb.h")
  # Google's own types, which users may have from elsewhere: where only users of curvereg::proto look.
  install(
    DIRECTORY "${generated_dir}/google"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/curvereg/proto"
    COMPONENT development
    FILES_MATCHING
    PATTERN "*.pb.h")
  # For clients in other languages.
  install(
    DIRECTORY proto/curvereg proto/google
    DESTINATION "${CMAKE_INSTALL_DATADIR}/curvereg/proto"
    COMPONENT development
    FILES_MATCHING
    PATTERN "*.proto")
endif()

configure_package_config_file(cmake/curveregConfig.cmake.in "${PROJECT_BINARY_DIR}/curveregConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/curveregConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(
  FILES "${PROJECT_BINARY_DIR}/curveregConfig.cmake" "${PROJECT_BINARY_DIR}/curveregConfigVersion.cmake"
  DESTINATION "${package_dir}"
  COMPONENT development)
