// SPDX-License-Identifier: BSD-3-Clause
// Loops over whole images, lines and codes exist twice: for every x86-64 and for those with AVX2, chosen when the program is loaded.
// They hold integers and single exact float operations only, so both give the same.
#pragma once

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define VOXID_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define VOXID_VECTORISED
#endif
