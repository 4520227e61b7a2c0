# SPDX-License-Identifier: MIT
# mdhcal_embed(TARGET NAME FOLDER): compile the TOML files of FOLDER into TARGET, so that the program finds them wherever
# it lies. offline/embedded.hpp declares what comes out: `embedded::NAME()`, sorted by name.
function(mdhcal_embed target name folder)
  file(GLOB files CONFIGURE_DEPENDS "${folder}/*.toml")
  list(SORT files)
  set(entries "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    string(REGEX REPLACE "^.*/([^/]*)\\.toml$" "\\1" stem "${file}")
    file(READ "${file}" text)
    string(APPEND entries "    {\"${stem}\", R\"file(${text})file\"},\n")
  endforeach()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp")
  set(made "// SPDX-License-Identifier: MIT
// Made by CMake.
#include \"offline/embedded.hpp\"

namespace mdhcal::offline::embedded {

namespace {

constexpr File ${name}_files[] = {
${entries}};

}  // namespace

std::span<const File> ${name}() { return ${name}_files; }

}  // namespace mdhcal::offline::embedded
")
  set(before "")
  if(EXISTS "${source}")
    file(READ "${source}" before)
  endif()
  if(NOT before STREQUAL made)
    file(WRITE "${source}" "${made}")
  endif()
  target_sources(${target} PRIVATE "${source}")
endfunction()
