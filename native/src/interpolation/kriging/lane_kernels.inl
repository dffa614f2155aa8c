// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels, compiled for one width of vector registers: LANES_NAME and LANES_WIDTH say which.
// Whoever includes this is compiled with instructions that not all processors have; so it calls no
// function of a header that others include as well, whose copy the linker could take for all.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <cstdint>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/lane_kernels.hpp"

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
constexpr int most_points = 256; // lane_kriging.hpp asks for no more

/// Eliminates systems with some rows behind the points'. The least pivot, for each lane.
Vector eliminate_all(double** rows, int points, int all_rows) {
    Vector least = all(1);
    for (int k = 0; k < points; ++k) {
        double* const pivot_row = rows[k];
        Vector pivot = load(pivot_row + k * lanes);
        for (int j = 0; j < k; ++j) {
            const Vector factor = load(pivot_row + j * lanes);
            pivot -= factor * factor;
        }
        least = pivot < least ? pivot : least;
        // What the nearer points leave open of this one; nothing: it is passed over.
        const Vector scale = pivot < redundant_variance
                                 ? all(0)
                                 : 1 / root(pivot < redundant_variance ? all(1) : pivot);
        int row = k + 1;
        for (; row + at_once <= all_rows; row += at_once)
            eliminate<at_once>(rows + row, pivot_row, k, scale);
        switch (all_rows - row) {
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
    return least;
}

/// Where the rows begin of which `numbers` are the first; those behind the points' have all points.
void find_rows(double** rows, double* numbers, int points, int all_rows) {
    for (int i = 0; i < points; ++i)
        rows[i] = numbers + (i * (i + 1) / 2) * lanes;
    for (int i = points; i < all_rows; ++i)
        rows[i] = numbers + (points * (points + 1) / 2 + (i - points) * points) * lanes;
}

void krige_part(int points, double* numbers, double* estimates, double* variances) {
    double* rows[most_points + 3];
    find_rows(rows, numbers, points, points + 3);
    eliminate_all(rows, points, points + 3);
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

Vector product(const double* a, const double* b, int points) {
    Vector sum = all(0);
    for (int k = 0; k < points; ++k)
        sum += load(a + k * lanes) * load(b + k * lanes);
    return sum;
}

/// Makes vectors orthonormal, each against those before it (modified Gram-Schmidt); upper[b][a] is
/// the part of the a-th along the b-th. The least part of any that those before it leave.
Vector make_orthonormal(double* const* vectors, int terms, int points,
                        Vector (*upper)[most_lane_terms]) {
    Vector least = all(1);
    for (int a = 0; a < terms; ++a) {
        const Vector whole = product(vectors[a], vectors[a], points);
        for (int b = 0; b < a; ++b) {
            const Vector part = product(vectors[b], vectors[a], points);
            upper[b][a] = part;
            for (int k = 0; k < points; ++k) {
                store(vectors[a] + k * lanes,
                      load(vectors[a] + k * lanes) - part * load(vectors[b] + k * lanes));
            }
        }
        const Vector left = product(vectors[a], vectors[a], points);
        const Vector share = left / (whole > 0.0 ? whole : all(1));
        least = share < least ? share : least;
        upper[a][a] = root(left > 0.0 ? left : all(1));
        for (int k = 0; k < points; ++k)
            store(vectors[a] + k * lanes, load(vectors[a] + k * lanes) / upper[a][a]);
    }
    return least;
}

// Of a term's square, what the terms before it must leave: terms less apart cost digits.
constexpr double well_apart = 1e-6;

/// universal_kriging, with the terms (1, 0, ..) at the place.
void krige_part_about_drift(int points, int terms, double* numbers, double* estimates,
                            double* variances, double* well_posed) {
    double* rows[most_points + 2 + most_lane_terms];
    find_rows(rows, numbers, points, points + 2 + terms);
    double* const* drift = rows + points + 1;
    Vector upper[most_lane_terms][most_lane_terms];

    // Whether they are told apart is seen of the terms as they are.
    alignas(64) double plain[most_lane_terms * most_points * lanes];
    double* copies[most_lane_terms] = {};
    for (int a = 0; a < terms; ++a) {
        copies[a] = plain + a * most_points * lanes;
        for (int k = 0; k < points; ++k)
            store(copies[a] + k * lanes, load(drift[a] + k * lanes));
    }
    const Vector apart = make_orthonormal(copies, terms, points, upper);

    const Vector pivot = eliminate_all(rows, points, points + 2 + terms);
    const Vector apart_then = make_orthonormal(drift, terms, points, upper);
    const double* const u = rows[points];
    const double* const t = rows[points + 1 + terms];
    Vector estimate = product(u, t, points), variance = 1 - product(u, u, points);
    Vector at_place[most_lane_terms];
    for (int a = 0; a < terms; ++a) {
        Vector sum = all(a == 0 ? 1 : 0);
        for (int b = 0; b < a; ++b)
            sum -= upper[b][a] * at_place[b];
        at_place[a] = sum / upper[a][a];
        const Vector open = at_place[a] - product(drift[a], u, points);
        estimate += open * product(drift[a], t, points);
        variance += open * open;
    }
    store(estimates, estimate);
    store(variances, variance > 0.0 ? variance : all(0));
    const Vector worst = apart < apart_then ? apart : apart_then;
    store(well_posed, pivot < redundant_variance ? all(0) : worst < well_apart ? all(0) : all(1));
}

void krige_about_drift(const LaneSystems& systems, double* estimates, double* variances,
                       double* well_posed) {
    for (int lane = 0; lane < lanes; lane += LANES_WIDTH) {
        krige_part_about_drift(systems.points, systems.terms, systems.rows + lane, estimates + lane,
                               variances + lane, well_posed + lane);
    }
}

void krige(const LaneSystems& systems, double* estimates, double* variances) {
    for (int lane = 0; lane < lanes; lane += LANES_WIDTH)
        krige_part(systems.points, systems.rows + lane, estimates + lane, variances + lane);
}

}  // namespace

extern const LaneKernels kernels;
const LaneKernels kernels{LANES_TEXT, &covariances, &krige, &krige_about_drift};

}  // namespace realmodel::interpolation::LANES_NAME
