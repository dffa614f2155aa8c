// SPDX-License-Identifier: GPL-3.0-or-later
// Whether GMP goes into a shared object: compiled by Gmp.cmake and never run. It takes in both
// kinds of code that could be in the way: arithmetic in assembler, and input and output.
#include <gmp.h>

#include <cstdio>

extern "C" int gmp_trial(const char* digits, FILE* file) {
    mpz_t a, b;
    mpz_init_set_str(a, digits, 10);
    mpz_init(b);
    mpz_mul(b, a, a);
    mpz_gcd(b, b, a);
    const int order = mpz_cmp(a, b) + static_cast<int>(mpz_inp_str(a, file, 10));
    gmp_printf("%Zd", a);
    mpz_clear(a);
    mpz_clear(b);
    return order;
}
