// Functions that run over rows of joints are compiled for each kind of processor, and chosen when
// the program is loaded. All give the same bits: nothing is fused (-ffp-contract=off), and each
// lane's numbers are added in one order. A template cannot be compiled so, its specialisations can.
#pragma once

// Sanitizers are not ready when that choice is made.
#ifndef LIMBER_EACH_PROCESSOR
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LIMBER_EACH_PROCESSOR [[gnu::target_clones("avx512f", "avx2", "default")]]
// Where single lanes serve as factors right after whole rows were written: from AVX-512's they take
// longer to come.
#define LIMBER_EACH_PROCESSOR_TO_AVX2 [[gnu::target_clones("avx2", "default")]]
#else
#define LIMBER_EACH_PROCESSOR
#endif
#endif
#ifndef LIMBER_EACH_PROCESSOR_TO_AVX2
#define LIMBER_EACH_PROCESSOR_TO_AVX2 LIMBER_EACH_PROCESSOR
#endif
