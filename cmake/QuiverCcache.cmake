# Compile through ccache when it is there. Paths below the checkout are made relative before they are hashed, so build
# folders and clones (CI, presets) share what they have compiled.
if(CMAKE_CXX_COMPILER_LAUNCHER)
  return()
endif()
find_program(QUIVER_CCACHE ccache)
mark_as_advanced(QUIVER_CCACHE)
if(QUIVER_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
                                  ${QUIVER_CCACHE})
endif()
