// SPDX-License-Identifier: BSD-3-Clause
// Replaces operator new in the program whose one source includes this, and counts.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<int> allocations{0};
}

void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* const memory = std::malloc(bytes)) return memory;
  std::abort();
}
// Inlined, free() would look to compilers as if it had been given what an operator new has made.
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
