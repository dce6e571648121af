# Sanitizers for everything of ours (QUIVER_SANITIZE), through the target quiver_flags.
if(NOT QUIVER_SANITIZE)
  return()
endif()

# Libraries are compiled for the fuzzer without its main(); the fuzzers add that themselves (tests/fuzz).
string(REGEX REPLACE "(^|,)fuzzer(,|$)" "\\1fuzzer-no-link\\2" quiver_sanitize "${QUIVER_SANITIZE}")
target_compile_options(quiver_flags INTERFACE -fsanitize=${quiver_sanitize} -fno-omit-frame-pointer)
target_link_options(quiver_flags INTERFACE -fsanitize=${quiver_sanitize})
if(QUIVER_SANITIZE MATCHES "undefined")
  target_compile_options(quiver_flags INTERFACE -fno-sanitize-recover=undefined)
endif()

# The unrolled kernels take minutes to compile with checks on every operation and at -O3: memory and threads are checked
# in them, arithmetic is not; fuzzers of readers do not need them at all.
file(GLOB quiver_kernels ${PROJECT_SOURCE_DIR}/solvers/cholesky/kernels/kernels_*.cpp)
set(quiver_kernel_options -O1 -fno-sanitize=undefined)
if(QUIVER_SANITIZE MATCHES "fuzzer")
  set(quiver_kernel_options -O1 -fno-sanitize=all)
endif()
if(quiver_kernels)
  set_property(SOURCE ${quiver_kernels} TARGET_DIRECTORY quiver APPEND PROPERTY COMPILE_OPTIONS ${quiver_kernel_options})
endif()
