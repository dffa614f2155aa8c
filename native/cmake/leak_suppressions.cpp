// SPDX-License-Identifier: GPL-3.0-or-later
// Linked into every program under AddressSanitizer, which asks for it by this name.

extern "C" const char* __lsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() {
    return "leak:libomp.so\n";  // clang's OpenMP runtime frees what its threads need only at exit
}
