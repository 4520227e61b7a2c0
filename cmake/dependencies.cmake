# SPDX-License-Identifier: MIT
# Dependencies come from the system's packages; off Debian, FetchContent is the fallback. Versions are Debian 12's.
include(FetchContent)

# mdhcal_dependency(PACKAGE TARGET URL TAG): find_package(PACKAGE), else fetch the tag; TARGET must then exist.
macro(mdhcal_dependency package target url tag)
  find_package(${package} QUIET)
  if(NOT TARGET ${target})
    message(STATUS "${package} is not installed: fetching ${url} at ${tag}")
    FetchContent_Declare(${package} GIT_REPOSITORY ${url} GIT_TAG ${tag} GIT_SHALLOW ON)
    FetchContent_MakeAvailable(${package})
  endif()
endmacro()
