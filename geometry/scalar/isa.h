#pragma once

/// \file
/// Instruction sets chosen at run time, one loop at a time.
///
/// Translation units are compiled for the baseline machine. A batch loop is a function that carries
/// QUIVER_BATCH_LOOP_AVX512 (or _AVX2): it may use that instruction set and pulls in (`flatten`) everything it calls,
/// so that code written on eight-wide `Lanes`, the user's included, ends up in vector registers without `-march`.
/// Within such a loop zeros written as the literal 0.0 fold away: its arithmetic assumes finite numbers and forgets the
/// sign of zero.
///
/// Rules for what runs inside: no lambda or function of another target that stays a call, no raw vector type in a
/// signature. On compilers other than GCC, and on machines other than x86-64, the macros are empty and `Lanes` are
/// plain loops that the compiler vectorises as its own flags allow.

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#  define QUIVER_NATIVE_LANES 1
#  define QUIVER_LANES_ALIGNMENT 64
// With prfchw, lines that another core wrote last come over once, to be written, not first to be read and then again.
// Machines that lack the instruction take it for a no-operation.
#  define QUIVER_TARGET_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx2,fma,prfchw")))
#  define QUIVER_TARGET_AVX2 __attribute__((target("avx2,fma,prfchw")))
#  define QUIVER_TARGET_PREFETCH __attribute__((target("prfchw")))
#  define QUIVER_TARGET_GENERIC
// A sanitizer's checks in a loop that has pulled in everything take minutes to compile: there, calls stay calls, and
// loops exist for AVX2 alone (QUIVER_EVERY_INSTRUCTION_SET is 0).
#  if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#    define QUIVER_FLATTEN
#    define QUIVER_EVERY_INSTRUCTION_SET 0
#  else
#    define QUIVER_FLATTEN __attribute__((flatten))
#    define QUIVER_EVERY_INSTRUCTION_SET 1
#  endif
#  define QUIVER_FOLD_ZEROS        \
    QUIVER_FLATTEN __attribute__(( \
        optimize("finite-math-only", "no-signed-zeros", "no-trapping-math", "no-tree-loop-distribute-patterns")))
#  define QUIVER_COLD __attribute__((noinline, cold))
#  define QUIVER_UNROLL _Pragma("GCC unroll 64")
#else
#  define QUIVER_NATIVE_LANES 0
#  define QUIVER_EVERY_INSTRUCTION_SET 0
#  define QUIVER_LANES_ALIGNMENT 8
#  define QUIVER_TARGET_AVX512
#  define QUIVER_TARGET_AVX2
#  define QUIVER_TARGET_PREFETCH
#  define QUIVER_TARGET_GENERIC
#  define QUIVER_FOLD_ZEROS
#  define QUIVER_COLD
#  define QUIVER_UNROLL
#endif

#define QUIVER_BATCH_LOOP_AVX512 QUIVER_TARGET_AVX512 QUIVER_FOLD_ZEROS
#define QUIVER_BATCH_LOOP_AVX2 QUIVER_TARGET_AVX2 QUIVER_FOLD_ZEROS
#define QUIVER_BATCH_LOOP_GENERIC QUIVER_FOLD_ZEROS

namespace quiver {

/// Tags that name the instruction set `Lanes` are computed with.
namespace isa {
struct Generic {};  ///< plain loops, every machine
struct Avx2 {};     ///< two registers of four doubles, with FMA
struct Avx512 {};   ///< one register of eight doubles
}  // namespace isa

/// Instruction sets in ascending order of capability.
enum class InstructionSet { generic, avx2, avx512 };

/// The best instruction set that this machine and its operating system support (registers saved on a context switch
/// included). Cheap; the answer never changes during a run.
inline InstructionSet detectInstructionSet() {
#if QUIVER_NATIVE_LANES
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (avx2 && avx512) return InstructionSet::avx512;
  if (avx2) return InstructionSet::avx2;
#endif
  return InstructionSet::generic;
}

}  // namespace quiver
