# Options, dependencies and the helpers every folder uses. Nothing here reaches a project that merely contains
# quiver (add_subdirectory, FetchContent): what is global is set at top level only.
include(GNUInstallDirs)

set(QUIVER_IS_TOP_LEVEL OFF)
if(CMAKE_SOURCE_DIR STREQUAL PROJECT_SOURCE_DIR)
  set(QUIVER_IS_TOP_LEVEL ON)
endif()

if(QUIVER_IS_TOP_LEVEL)
  option(BUILD_SHARED_LIBS "Build quiver as a shared library (plugins need it)" ON)
elseif(NOT DEFINED BUILD_SHARED_LIBS)
  set(BUILD_SHARED_LIBS ON)
endif()
option(QUIVER_WITH_CHOLMOD "Build quiver::cholmod, the SuiteSparse backend (GPL)" ON)
option(QUIVER_WITH_OPENMP "Run parallel loops on OpenMP; otherwise on a pool of threads, which suffers less on a busy machine" OFF)
option(QUIVER_WITH_METIS "Offer nested dissection by METIS" ON)
option(QUIVER_BUILD_APPS "Build the quiver command" ${QUIVER_IS_TOP_LEVEL})
option(QUIVER_BUILD_EXAMPLES "Build the examples" ${QUIVER_IS_TOP_LEVEL})
option(QUIVER_BUILD_TESTS "Build the tests" ${QUIVER_IS_TOP_LEVEL})
option(QUIVER_BUILD_BENCHMARKS "Build the benchmarks" OFF)
option(QUIVER_INSTALL "Offer an install target" ${QUIVER_IS_TOP_LEVEL})
set(QUIVER_SANITIZE "" CACHE STRING
    "Sanitizers to compile with: address,undefined or thread; with fuzzer in the list (Clang), the fuzzers are built")

if(QUIVER_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  include(QuiverCcache)
endif()

# quiver_find(...) is find_package(... REQUIRED) whose imported targets are visible in the whole build: a project that
# contains quiver links quiver::quiver without having to find Eigen itself.
macro(quiver_find)
  find_package(${ARGN} REQUIRED)
  get_property(quiver_imported DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(quiver_target IN LISTS quiver_imported)
    set_target_properties(${quiver_target} PROPERTIES IMPORTED_GLOBAL TRUE)
  endforeach()
endmacro()

quiver_find(Eigen3 3.4 NO_MODULE)
quiver_find(Threads)
quiver_find(fmt)
quiver_find(ZLIB)
quiver_find(BZip2)
if(QUIVER_WITH_OPENMP)
  find_package(OpenMP REQUIRED COMPONENTS CXX)
endif()
if(QUIVER_WITH_METIS)
  find_path(METIS_INCLUDE_DIR metis.h REQUIRED)
  find_library(METIS_LIBRARY metis REQUIRED)
  mark_as_advanced(METIS_INCLUDE_DIR METIS_LIBRARY)
endif()

# Warnings and sanitizers for everything of ours; never exported to users.
add_library(quiver_flags INTERFACE)
target_compile_features(quiver_flags INTERFACE cxx_std_20)
# Without interposition functions of the library call and inline each other directly: nobody replaces single ones.
target_compile_options(quiver_flags INTERFACE -Wall -Wextra -Wno-psabi -fno-math-errno -fno-semantic-interposition)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # The compiler collects its garbage from 1 GB on: a tenth less time, for up to half more memory.
  target_compile_options(quiver_flags INTERFACE --param=ggc-min-heapsize=1048576)
endif()

# The public include folder: build/include/quiver/<folder> links to the source folder, so that
# <quiver/core/...> is spelled the same in the build tree and after installation.
set(QUIVER_PUBLIC_FOLDERS core geometry solvers initialization smoothing evaluation types_slam2d types_slam3d types_sba plugins)
set(QUIVER_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${QUIVER_INCLUDE_DIR}/quiver)
foreach(folder ${QUIVER_PUBLIC_FOLDERS})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${QUIVER_INCLUDE_DIR}/quiver/${folder} SYMBOLIC)
endforeach()
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/core/quiver.h ${QUIVER_INCLUDE_DIR}/quiver/quiver.h SYMBOLIC)
configure_file(${PROJECT_SOURCE_DIR}/cmake/version.h.in ${QUIVER_INCLUDE_DIR}/quiver/version.h)

function(quiver_configure_library target)
  target_link_libraries(${target} PUBLIC Eigen3::Eigen)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:quiver_flags> fmt::fmt ZLIB::ZLIB BZip2::BZip2
                                          Threads::Threads ${CMAKE_DL_LIBS})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${QUIVER_INCLUDE_DIR}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(BUILD_SHARED_LIBS AND NOT QUIVER_SANITIZE AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
    # A definition somebody forgot is an error here, not in the first program that links.
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
  if(BUILD_SHARED_LIBS AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
    # Calls within the library are bound when it is linked: fewer symbols to look up at every start of a program.
    target_link_options(${target} PRIVATE -Wl,-Bsymbolic-functions)
  endif()
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION}
                                             SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  if(QUIVER_WITH_OPENMP)
    # Threads are made in one file only, so only that file is compiled for OpenMP.
    target_link_libraries(${target} PRIVATE ${OpenMP_CXX_LIBRARIES})
    set_source_files_properties(${PROJECT_SOURCE_DIR}/core/util/parallel.cpp TARGET_DIRECTORY ${target}
                                PROPERTIES COMPILE_OPTIONS "${OpenMP_CXX_FLAGS}" COMPILE_DEFINITIONS QUIVER_OPENMP=1)
  endif()
  if(QUIVER_WITH_METIS)
    target_include_directories(${target} PRIVATE ${METIS_INCLUDE_DIR})
    target_link_libraries(${target} PRIVATE ${METIS_LIBRARY})
    target_compile_definitions(${target} PRIVATE QUIVER_METIS=1)
  endif()
endfunction()

# quiver_folder(): every .cpp below the calling folder becomes part of the library.
function(quiver_folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  target_sources(quiver PRIVATE ${sources})
endfunction()
