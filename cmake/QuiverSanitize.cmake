# Sanitizers for everything of ours (QUIVER_SANITIZE), through the target quiver_flags, at a price that lets CI run them:
# what a check would find twice is checked once, and what a build does not run is not instrumented. Batch loops exist
# for one instruction set alone (geometry/scalar/isa.h).
if(NOT QUIVER_SANITIZE)
  return()
endif()

# Libraries are compiled for the fuzzer without its main(); the fuzzers add that themselves (tests/fuzz).
string(REGEX REPLACE "(^|,)fuzzer(,|$)" "\\1fuzzer-no-link\\2" quiver_sanitize "${QUIVER_SANITIZE}")
target_compile_options(quiver_flags INTERFACE -fsanitize=${quiver_sanitize} -fno-omit-frame-pointer)
target_link_options(quiver_flags INTERFACE -fsanitize=${quiver_sanitize})
if(QUIVER_SANITIZE MATCHES "undefined")
  # Null pointers and the size of objects are what the address sanitizer sees anyway; no class here is cast down wrongly
  # without being read wrongly.
  target_compile_options(quiver_flags INTERFACE -fno-sanitize-recover=undefined -fno-sanitize=null,object-size,vptr)
endif()

# quiver_compile(FILES OPTIONS...): options for some files of the library, behind those that they have.
function(quiver_compile files)
  if(files)
    set_property(SOURCE ${files} TARGET_DIRECTORY quiver APPEND PROPERTY COMPILE_OPTIONS ${ARGN})
  endif()
endfunction()

# The unrolled kernels take minutes to compile with checks on every operation and at -O3: memory and threads are checked
# in them, arithmetic is not.
file(GLOB quiver_kernels ${PROJECT_SOURCE_DIR}/solvers/*/kernels/*kernels_*.cpp)
if(QUIVER_SANITIZE MATCHES "undefined")
  quiver_compile("${quiver_kernels}" -fno-sanitize=undefined)
endif()
quiver_compile("${quiver_kernels}" -O1)

# Fuzzers read and write: what solves is linked, but never runs.
if(QUIVER_SANITIZE MATCHES "fuzzer")
  file(GLOB_RECURSE quiver_never_run
       ${PROJECT_SOURCE_DIR}/solvers/*.cpp ${PROJECT_SOURCE_DIR}/initialization/*.cpp
       ${PROJECT_SOURCE_DIR}/smoothing/*.cpp ${PROJECT_SOURCE_DIR}/evaluation/*.cpp ${PROJECT_SOURCE_DIR}/core/algorithm/*.cpp)
  list(FILTER quiver_never_run EXCLUDE REGEX "/backends/cholmod/")
  quiver_compile("${quiver_never_run}" -O0 -g0 -fno-sanitize=all)
endif()
