# Installation: headers, libraries, the command and the package configuration.
# What is installed is spelled as in the build tree: <quiver/core/...>, quiver::quiver, quiver::cholmod.
include(CMakePackageConfigHelpers)

set(quiver_installed quiver)
if(TARGET quiver_cholmod)
  set_target_properties(quiver_cholmod PROPERTIES EXPORT_NAME cholmod)
  if(NOT TARGET quiver::cholmod)
    add_library(quiver::cholmod ALIAS quiver_cholmod)
  endif()
  list(APPEND quiver_installed quiver_cholmod)
endif()

# Libraries and the command find each other wherever the prefix is moved to.
file(RELATIVE_PATH quiver_bin_to_lib ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(${quiver_installed} PROPERTIES INSTALL_RPATH "$ORIGIN")
if(TARGET quiver_command)
  set_target_properties(quiver_command PROPERTIES INSTALL_RPATH "$ORIGIN/${quiver_bin_to_lib}")
endif()

if(NOT QUIVER_INSTALL)
  return()
endif()

install(TARGETS ${quiver_installed} EXPORT quiverTargets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET quiver_command)
  install(TARGETS quiver_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(quiver_left_out)
if(NOT TARGET quiver_cholmod)
  set(quiver_left_out PATTERN "backends/cholmod" EXCLUDE)
endif()
foreach(folder ${QUIVER_PUBLIC_FOLDERS})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/quiver
          FILES_MATCHING PATTERN "*.h" ${quiver_left_out})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/core/quiver.h ${QUIVER_INCLUDE_DIR}/quiver/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/quiver)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(quiver_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/quiver)
install(EXPORT quiverTargets NAMESPACE quiver:: DESTINATION ${quiver_package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/quiverConfig.cmake.in ${PROJECT_BINARY_DIR}/quiverConfig.cmake
                              INSTALL_DESTINATION ${quiver_package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/quiverConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/quiverConfig.cmake ${PROJECT_BINARY_DIR}/quiverConfigVersion.cmake
        DESTINATION ${quiver_package_dir})
