// SPDX-License-Identifier: BSD-3-Clause
// Loops over whole images, lines and codes exist three times: for every x86-64, for those with AVX2 and for those with
// AVX-512, chosen when the program is loaded. They hold integers and single exact float operations only, so all three
// give the same.
#pragma once

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define VOXID_VECTORISED __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define VOXID_VECTORISED
#endif
