# SPDX-License-Identifier: MIT
# Installs the libraries with a CMake package and a pkg-config file, both relocatable; the host tool goes beside them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(packaging "${CMAKE_CURRENT_LIST_DIR}")
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/mdhcal")

set_target_properties(mdhcal_rt PROPERTIES EXPORT_NAME rt)
set_target_properties(mdhcal_port PROPERTIES EXPORT_NAME port)
install(TARGETS mdhcal_rt mdhcal_port EXPORT mdhcalTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        COMPONENT library)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/lib/include/" "${PROJECT_SOURCE_DIR}/port/include/"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT library FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(EXPORT mdhcalTargets NAMESPACE mdhcal:: DESTINATION "${package_folder}" COMPONENT library)
# Apart: who loads its targets needs libsodium.
if(TARGET mdhcal_port_sodium)
  set_target_properties(mdhcal_port_sodium PROPERTIES EXPORT_NAME port_sodium)
  install(TARGETS mdhcal_port_sodium EXPORT mdhcalSodiumTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
          COMPONENT library)
  install(EXPORT mdhcalSodiumTargets NAMESPACE mdhcal:: DESTINATION "${package_folder}" COMPONENT library)
  install(FILES "${PROJECT_SOURCE_DIR}/cmake/Findsodium.cmake" DESTINATION "${package_folder}" COMPONENT library)
endif()

configure_package_config_file("${packaging}/mdhcalConfig.cmake.in" "${PROJECT_BINARY_DIR}/mdhcalConfig.cmake"
                              INSTALL_DESTINATION "${package_folder}")
# Before version 1, the minor version counts.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/mdhcalConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/mdhcalConfig.cmake" "${PROJECT_BINARY_DIR}/mdhcalConfigVersion.cmake"
        DESTINATION "${package_folder}" COMPONENT library)

file(RELATIVE_PATH prefix_from_pc "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file("${packaging}/mdhcal.pc.in" "${PROJECT_BINARY_DIR}/mdhcal.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/mdhcal.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT library)

if(TARGET mdhcal)
  install(TARGETS mdhcal RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT tool)
endif()
