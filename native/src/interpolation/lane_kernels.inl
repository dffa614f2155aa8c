// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels, compiled for one width of vector registers: LANES_NAME and LANES_WIDTH say which.
// Whoever includes this is compiled with instructions that not all processors have; so it calls no
// function of a header that others include as well, whose copy the linker could take for all.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <cstdint>

#include "interpolation/covariance.hpp"
#include "interpolation/lane_kernels.hpp"

namespace realmodel::interpolation::LANES_NAME {

namespace {

using Vector = double __attribute__((vector_size(8 * LANES_WIDTH)));
using Whole = std::int64_t __attribute__((vector_size(8 * LANES_WIDTH)));

inline Vector all(double value) {
    return Vector{} + value;
}

inline Vector load(const double* from) {
    Vector v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

inline void store(double* to, Vector v) {
    __builtin_memcpy(to, &v, sizeof v);
}

inline Vector root(Vector v) {
#if LANES_WIDTH == 8 && defined(__AVX512F__)
    return _mm512_maskz_sqrt_pd(0xff, v);  // g++ 12 warns of what _mm512_sqrt_pd leaves open
#elif LANES_WIDTH == 4 && defined(__AVX__)
    return _mm256_sqrt_pd(v);
#elif LANES_WIDTH == 2 && defined(__SSE2__)
    return _mm_sqrt_pd(v);
#else
    for (int lane = 0; lane < LANES_WIDTH; ++lane)
        v[lane] = __builtin_sqrt(v[lane]);
    return v;
#endif
}

/// `decay`.
inline Vector decay_of(Vector x) {
    namespace e = exponential;
    const Vector y = x < e::largest ? -x : all(-e::largest);
    const Vector shifted = y * e::per_log2 + e::rounder;
    const Vector n = shifted - e::rounder;
    const Vector r = (y - n * e::log2_high) - n * e::log2_low;
    Vector sum = all(e::series[0]);
    for (int term = 1; term < e::terms; ++term)
        sum = sum * r + e::series[term];
    Whole bits, exponent;
    __builtin_memcpy(&bits, &sum, sizeof bits);
    __builtin_memcpy(&exponent, &shifted, sizeof exponent);
    bits += exponent << 52;
    __builtin_memcpy(&sum, &bits, sizeof bits);
    return sum;
}

/// `covariance_of`.
inline Vector part_covariance(const CovariancePart& part, Vector dx, Vector dy) {
    const Vector along = part.xx * dx + part.xy * dy;
    const Vector across = part.yx * dx + part.yy * dy;
    const Vector square = along * along + across * across;
    if (part.model == VariogramModel::gaussian) return part.share * decay_of(3 * square);
    const Vector t = root(square);
    switch (part.model) {
        case VariogramModel::spherical:
            return part.share * (t < 1.0 ? 1 - t * (1.5 - 0.5 * square) : all(0));
        case VariogramModel::exponential:
            return part.share * decay_of(3 * t);
        case VariogramModel::cubic:
            return part.share *
                   (t < 1.0 ? 1 - square * (7 - t * (8.75 - square * (3.5 - 0.75 * square)))
                            : all(0));
        case VariogramModel::matern32: {
            const Vector s = matern32_scale * t;
            return part.share * ((1 + s) * decay_of(s));
        }
        default: {
            const Vector s = matern52_scale * t;
            return part.share * ((1 + s * (1 + s * third)) * decay_of(s));
        }
    }
}

void covariances(const CovariancePart* parts, std::size_t part_count, const double* dx,
                 const double* dy, double* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += LANES_WIDTH) {
        const Vector x = load(dx + i), y = load(dy + i);
        Vector sum = part_covariance(parts[0], x, y);
        for (std::size_t part = 1; part < part_count; ++part)
            sum += part_covariance(parts[part], x, y);
        store(out + i, sum);
    }
}

/// Column k of the factor in rows first .. first + count - 1, of which row r begins at rows[r].
template <int count>
inline void eliminate(double* const* rows, const double* pivot_row, int k, Vector scale) {
    Vector sum[count];
    for (int r = 0; r < count; ++r)
        sum[r] = load(rows[r] + k * lanes);
    for (int j = 0; j < k; ++j) {
        const Vector factor = load(pivot_row + j * lanes);
        for (int r = 0; r < count; ++r)
            sum[r] -= load(rows[r] + j * lanes) * factor;
    }
    for (int r = 0; r < count; ++r)
        store(rows[r] + k * lanes, sum[r] * scale);
}

constexpr int at_once = 4;       // rows whose sums are in registers together
constexpr int most_points = 64;  // lane_kriging.hpp asks for no more

void krige_part(int points, double* numbers, double* estimates, double* variances) {
    double* rows[most_points + 3];
    for (int i = 0; i < points; ++i)
        rows[i] = numbers + (i * (i + 1) / 2) * lanes;
    for (int extra = 0; extra < 3; ++extra)
        rows[points + extra] = numbers + (points * (points + 1) / 2 + extra * points) * lanes;

    for (int k = 0; k < points; ++k) {
        double* const pivot_row = rows[k];
        Vector pivot = load(pivot_row + k * lanes);
        for (int j = 0; j < k; ++j) {
            const Vector factor = load(pivot_row + j * lanes);
            pivot -= factor * factor;
        }
        // What the nearer points leave open of this one; nothing: it is passed over.
        const Vector scale = pivot < redundant_variance
                                 ? all(0)
                                 : 1 / root(pivot < redundant_variance ? all(1) : pivot);
        int row = k + 1;
        for (; row + at_once <= points + 3; row += at_once)
            eliminate<at_once>(rows + row, pivot_row, k, scale);
        switch (points + 3 - row) {
            case 3:
                eliminate<3>(rows + row, pivot_row, k, scale);
                break;
            case 2:
                eliminate<2>(rows + row, pivot_row, k, scale);
                break;
            case 1:
                eliminate<1>(rows + row, pivot_row, k, scale);
                break;
            default:
                break;
        }
    }
    Vector uu = all(0), us = all(0), ut = all(0), ss = all(0), st = all(0);
    for (int k = 0; k < points; ++k) {
        const Vector u = load(rows[points] + k * lanes), s = load(rows[points + 1] + k * lanes),
                     t = load(rows[points + 2] + k * lanes);
        uu += u * u;
        us += u * s;
        ut += u * t;
        ss += s * s;
        st += s * t;
    }
    // ordinary_kriging
    const Vector excess = us - 1;
    const Vector variance = 1 - uu + excess * excess / ss;
    store(estimates, ut - excess / ss * st);
    store(variances, variance > 0.0 ? variance : all(0));
}

void krige(const LaneSystems& systems, double* estimates, double* variances) {
    for (int lane = 0; lane < lanes; lane += LANES_WIDTH)
        krige_part(systems.points, systems.rows + lane, estimates + lane, variances + lane);
}

}  // namespace

extern const LaneKernels kernels;
const LaneKernels kernels{LANES_TEXT, &covariances, &krige};

}  // namespace realmodel::interpolation::LANES_NAME
