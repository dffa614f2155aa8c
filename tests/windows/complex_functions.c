/* SPDX-License-Identifier: GPL-3.0-or-later
   The functions of complex numbers of Windows' C library, which Wine lacks and NumPy 2 asks for when it is loaded, by
   those of mingw-w64. Test equipment: scripts/test_windows.sh makes a DLL of it, which passes all others on. */
#include <complex.h>

typedef struct {
    double at[2];
} Complex;
typedef struct {
    float at[2];
} FloatComplex;

#define VALUE(z) __builtin_complex((double)(z).at[0], (double)(z).at[1])
#define FUNCTION(name)                            \
    Complex own_##name(Complex z) {               \
        const double complex w = name(VALUE(z));  \
        return (Complex){{creal(w), cimag(w)}};   \
    }                                             \
    FloatComplex own_##name##f(FloatComplex z) {  \
        const double complex w = name(VALUE(z));  \
        return (FloatComplex){{creal(w), cimag(w)}}; \
    }
#define MEASURE(name)                  \
    double own_##name(Complex z) {     \
        return name(VALUE(z));         \
    }                                  \
    float own_##name##f(FloatComplex z) { \
        return name(VALUE(z));         \
    }

FUNCTION(ccos)
FUNCTION(ccosh)
FUNCTION(cexp)
FUNCTION(csin)
FUNCTION(csinh)
FUNCTION(ctan)
FUNCTION(ctanh)
MEASURE(cabs)
MEASURE(carg)
MEASURE(cimag)
MEASURE(creal)

Complex own_cpow(Complex z, Complex p) {
    const double complex w = cpow(VALUE(z), VALUE(p));
    return (Complex){{creal(w), cimag(w)}};
}
FloatComplex own_cpowf(FloatComplex z, FloatComplex p) {
    const double complex w = cpow(VALUE(z), VALUE(p));
    return (FloatComplex){{creal(w), cimag(w)}};
}
