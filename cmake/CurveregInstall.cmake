# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# What users of the libraries need, as component "development": static libraries, headers below include/curvereg (so
# that #include "client/client.h" works for them as it does here), and the package for find_package(curvereg).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(CURVEREG_INSTALLED core methods baselines flann opencv render files)
if(CURVEREG_BUILD_SERVER)
  list(APPEND CURVEREG_INSTALLED proto wire client)
endif()

set(include_dir "${CMAKE_INSTALL_INCLUDEDIR}/curvereg")
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/curvereg")
foreach(name ${CURVEREG_INSTALLED})
  set_target_properties(curvereg_${name} PROPERTIES EXPORT_NAME ${name})
  install(
    TARGETS curvereg_${name}
    EXPORT curveregTargets
    COMPONENT development
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
    INCLUDES
    DESTINATION "${include_dir}")
endforeach()

install(
  DIRECTORY core render
  DESTINATION "${include_dir}"
  COMPONENT development
  FILES_MATCHING
  PATTERN "*.h"
  PATTERN "baselines" EXCLUDE)
install(
  DIRECTORY client/files
  DESTINATION "${include_dir}/client"
  COMPONENT development
  FILES_MATCHING
  PATTERN "*.h")
if(CURVEREG_BUILD_SERVER)
  install(
    FILES client/client.h client/traverse_types.h client/traverses.h
    DESTINATION "${include_dir}/client"
    COMPONENT development)
  install(
    DIRECTORY wire
    DESTINATION "${include_dir}"
    COMPONENT development
    FILES_MATCHING
    PATTERN "*.h")
  install(
    DIRECTORY "${PROJECT_BINARY_DIR}/proto/generated/"
    DESTINATION "${include_dir}"
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

install(
  EXPORT curveregTargets
  NAMESPACE curvereg::
  DESTINATION "${package_dir}"
  COMPONENT development)
configure_package_config_file(cmake/curveregConfig.cmake.in "${PROJECT_BINARY_DIR}/curveregConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/curveregConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(
  FILES "${PROJECT_BINARY_DIR}/curveregConfig.cmake" "${PROJECT_BINARY_DIR}/curveregConfigVersion.cmake"
  DESTINATION "${package_dir}"
  COMPONENT development)
