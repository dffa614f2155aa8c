// SPDX-License-Identifier: GPL-3.0-or-later
// What musl's files here take from its own libm.h, as C++. Each name that they define gets "realmodel_" before it, so
// that none is that of a C library.
#pragma once

#include <bit>
#include <cfloat>
#include <cstdint>
#include <math.h>

static_assert(FLT_EVAL_METHOD == 0, "doubles are computed with more digits than they have: other bytes");
#undef __FP_FAST_FMA // where a processor has it: without it, the same bytes as on the others

#define WANT_ROUNDING 1
#define TOINT_INTRINSICS 0
#define issignaling_inline(x) 0
#define predict_true(x) __builtin_expect(!!(x), 1)
#define predict_false(x) __builtin_expect(!!(x), 0)
#define hidden

#define acos realmodel_acos
#define atan realmodel_atan
#define atan2 realmodel_atan2
#define cos realmodel_cos
#define exp realmodel_exp
#define expm1 realmodel_expm1
#define hypot realmodel_hypot
#define log realmodel_log
#define pow realmodel_pow
#define sin realmodel_sin
#define __cos realmodel_cos_kernel
#define __exp_data realmodel_exp_data
#define __log_data realmodel_log_data
#define __math_divzero realmodel_math_divzero
#define __math_invalid realmodel_math_invalid
#define __math_oflow realmodel_math_oflow
#define __math_uflow realmodel_math_uflow
#define __math_xflow realmodel_math_xflow
#define __pow_log_data realmodel_pow_log_data
#define __rem_pio2 realmodel_rem_pio2
#define __rem_pio2_large realmodel_rem_pio2_large
#define __sin realmodel_sin_kernel

double acos(double x);
double atan(double x);
double atan2(double y, double x);
double cos(double x);
double exp(double x);
double expm1(double x);
double hypot(double x, double y);
double log(double x);
double pow(double x, double y);
double sin(double x);

double __cos(double x, double y);
double __math_divzero(uint32_t sign);
double __math_invalid(double x);
double __math_oflow(uint32_t sign);
double __math_uflow(uint32_t sign);
double __math_xflow(uint32_t sign, double y);
int __rem_pio2(double x, double* y);
int __rem_pio2_large(double* x, double* y, int e0, int nx, int prec);
double __sin(double x, double y, int iy);

inline uint64_t asuint64(double x) {
    return std::bit_cast<uint64_t>(x);
}
inline double asdouble(uint64_t bits) {
    return std::bit_cast<double>(bits);
}
inline double eval_as_double(double x) {
    return x;
}
inline double fp_barrier(double x) {
    volatile double y = x;
    return y;
}
// These raise flags of floating point in C, which nobody asks for here.
#define fp_force_eval(x) (void)(x)
#define FORCE_EVAL(x) (void)(x)

#define EXTRACT_WORDS(high, low, x) ((high) = uint32_t(asuint64(x) >> 32), (low) = uint32_t(asuint64(x)))
#define GET_HIGH_WORD(high, x) ((high) = uint32_t(asuint64(x) >> 32))
#define GET_LOW_WORD(low, x) ((low) = uint32_t(asuint64(x)))
#define SET_LOW_WORD(x, low) ((x) = asdouble((asuint64(x) >> 32 << 32) | uint32_t(low)))
