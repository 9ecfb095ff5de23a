# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# Writes the public headers into a folder of the build tree under the names that users include:
#
#   client/client.h      -> curvereg/client.h
#   core/scan/scan.h     -> curvereg/core/scan/scan.h        (files/, render/ and wire/ likewise)
#
# and renames them in the text likewise, so that all headers lie below one prefix and PREFIX/include is the only search
# path that they need. cmake/CurveregInstall.cmake runs this at install time and installs that folder. By hand:
#
#   cmake -D source_dir=. -D "headers=client/client.h;core/scan/scan.h" -D generated_dir=build/release/proto/generated
#         -D output_dir=OUT -P cmake/InstallHeaders.cmake
#
# Fails when a header includes one of ours that is not among `headers` and not generated.
cmake_minimum_required(VERSION 3.25)

# Names of our headers in `text`, as users include them.
function(curvereg_installed_names text result)
  string(REGEX REPLACE "(^|[^A-Za-z0-9_./])client/([a-z0-9_/]+[.]h)" "\\1curvereg/\\2" text "${text}")
  string(REGEX REPLACE "(^|[^A-Za-z0-9_./])(core|files|render|wire)/([a-z0-9_/]+[.]h)" "\\1curvereg/\\2/\\3" text "${text}")
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

# An include with quotes must be found by users: a header among `installed`, a generated one, or another library's.
function(curvereg_check_include name header installed)
  if(name MATCHES "^(absl|google)/" OR name IN_LIST installed)
    return()
  endif()
  if(name MATCHES "[.]pb[.]h$" AND EXISTS "${generated_dir}/${name}")
    return()
  endif()
  message(FATAL_ERROR "${header} includes \"${name}\", which is not installed (cmake/CurveregInstall.cmake has the list)")
endfunction()

file(LOCK "${output_dir}.lock" GUARD PROCESS TIMEOUT 600)  # two installations of one build share the folder
curvereg_installed_names("${headers}" installed)
file(REMOVE_RECURSE "${output_dir}.old")
if(EXISTS "${output_dir}")
  file(RENAME "${output_dir}" "${output_dir}.old")
endif()
foreach(header name IN ZIP_LISTS headers installed)
  file(READ "${source_dir}/${header}" text)
  curvereg_installed_names("${text}" text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(include ${includes})
    string(REGEX REPLACE "#include \"(.+)\"" "\\1" include "${include}")
    curvereg_check_include("${include}" "${header}" "${installed}")
  endforeach()
  file(WRITE "${output_dir}/${name}" "${text}")
  # A header that did not change keeps its time, so that its users need not be compiled again.
  file(SHA256 "${output_dir}/${name}" hash)
  if(EXISTS "${output_dir}.old/${name}")
    file(SHA256 "${output_dir}.old/${name}" old_hash)
    if(hash STREQUAL old_hash)
      file(RENAME "${output_dir}.old/${name}" "${output_dir}/${name}")
    endif()
  endif()
endforeach()
file(REMOVE_RECURSE "${output_dir}.old")
