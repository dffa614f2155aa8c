// SPDX-License-Identifier: GPL-3.0-or-later
// The three streams of the C library for a GMP that is linked into a shared object: see Gmp.cmake.
// With --wrap=NAME the linker turns GMP's NAME into __wrap_NAME, and __real_NAME into the C
// library's.
#include <cstdio>

// The names are the linker's. NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
extern FILE* __real_stdin;
extern FILE* __real_stdout;
extern FILE* __real_stderr;

// Hidden, or GMP could not address them directly.
extern __attribute__((visibility("hidden"))) FILE* __wrap_stdin;
extern __attribute__((visibility("hidden"))) FILE* __wrap_stdout;
extern __attribute__((visibility("hidden"))) FILE* __wrap_stderr;

FILE* __wrap_stdin = __real_stdin;
FILE* __wrap_stdout = __real_stdout;
FILE* __wrap_stderr = __real_stderr;
}
// NOLINTEND(bugprone-reserved-identifier)
