// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels for one width of vector registers: that which every processor has, or a wider one,
// for which native/CMakeLists.txt has this source compiled again, with other instructions and a
// name and width of its own. So it calls no function of a header that others call as well, whose
// copy the linker could take for all, but templates on a vector of this width, which nobody else
// uses.
#include "interpolation/kriging/lane_kernels.hpp"

#if defined(__SSE2__) && !defined(REALMODEL_PLAIN_DOUBLE)
#include <immintrin.h>
#endif

#include <cstdint>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"

#ifndef LANES_NAME
#define LANES_NAME baseline
#define LANES_WIDTH 2
#endif
#define LANES_TEXT_OF(name) #name
#define LANES_TEXT(name) LANES_TEXT_OF(name)

namespace realmodel::interpolation::LANES_NAME {

namespace {

using Lanes = double __attribute__((vector_size(8 * LANES_WIDTH)));
using Bits = std::uint64_t __attribute__((vector_size(8 * LANES_WIDTH)));

inline Lanes all(double value) {
    return Lanes{} + value;
}

inline Lanes load(const double* from) {
    Lanes v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

inline void store(double* to, Lanes v) {
    __builtin_memcpy(to, &v, sizeof v);
}

inline Lanes root(Lanes v) {
#if LANES_WIDTH == 8 && defined(__AVX512F__)
    return _mm512_maskz_sqrt_pd(0xff, v);  // g++ 12 warns of what _mm512_sqrt_pd leaves open
#elif LANES_WIDTH == 4 && defined(__AVX__)
    return _mm256_sqrt_pd(v);
#elif LANES_WIDTH == 2 && defined(__SSE2__) && !defined(REALMODEL_PLAIN_DOUBLE)
    return _mm_sqrt_pd(v);
#else
    for (int lane = 0; lane < LANES_WIDTH; ++lane)
        v[lane] = __builtin_sqrt(v[lane]);
    return v;
#endif
}

/// Adds one part to the covariances, or begins with it. Each model has a loop of its own, which
/// does not ask again for each number what model it is.
template <VariogramModel model>
void add_covariances(CovarianceStructure structure, bool is_first, const double* dx,
                     const double* dy, double* out, std::size_t count) {
    const auto square_root = [](Lanes v) { return root(v); };
    structure.model = model;
    for (std::size_t i = 0; i < count; i += LANES_WIDTH) {
        const Lanes addend =
            covariance_of<Bits>(structure, load(dx + i), load(dy + i), square_root);
        store(out + i, is_first ? addend : load(out + i) + addend);
    }
}

void covariances(const CovarianceStructure* structures, std::size_t structure_count,
                 const double* dx, const double* dy, double* out, std::size_t count) {
    for (std::size_t structure = 0; structure < structure_count; ++structure) {
        const auto add = [&] {
            switch (structures[structure].model) {
                case VariogramModel::kSpherical:
                    return &add_covariances<VariogramModel::kSpherical>;
                case VariogramModel::kExponential:
                    return &add_covariances<VariogramModel::kExponential>;
                case VariogramModel::kCubic:
                    return &add_covariances<VariogramModel::kCubic>;
                case VariogramModel::kGaussian:
                    return &add_covariances<VariogramModel::kGaussian>;
                case VariogramModel::kMatern32:
                    return &add_covariances<VariogramModel::kMatern32>;
                case VariogramModel::kWave:
                    return &add_covariances<VariogramModel::kWave>;
                default:
                    return &add_covariances<VariogramModel::kMatern52>;
            }
        }();
        add(structures[structure], structure == 0, dx, dy, out, count);
    }
}

void add_scaled(double share, const double* structure, bool is_first, double* sum,
                std::size_t count) {
    for (std::size_t i = 0; i < count; i += LANES_WIDTH) {
        const Lanes scaled = share * load(structure + i);
        store(sum + i, is_first ? scaled : load(sum + i) + scaled);
    }
}

void differences(const double* coordinates, std::size_t points, double* out) {
    for (std::size_t i = 0; i <= points; ++i) {
        const std::size_t others = i < points ? i + 1 : points;
        for (std::size_t j = 0; j < others; ++j, out += kLanes) {
            for (int lane = 0; lane < kLanes; lane += LANES_WIDTH) {
                store(out + lane, load(coordinates + i * kLanes + lane) -
                                      load(coordinates + j * kLanes + lane));
            }
        }
    }
}

/// Column k of the factor in rows first .. first + count - 1, of which row r begins at rows[r].
template <int count>
inline void eliminate(double* const* rows, const double* pivot_row, int k, Lanes scale) {
    Lanes sum[count];
    for (int r = 0; r < count; ++r)
        sum[r] = load(rows[r] + k * kLanes);
    for (int j = 0; j < k; ++j) {
        const Lanes factor = load(pivot_row + j * kLanes);
        for (int r = 0; r < count; ++r)
            sum[r] -= load(rows[r] + j * kLanes) * factor;
    }
    for (int r = 0; r < count; ++r)
        store(rows[r] + k * kLanes, sum[r] * scale);
}

constexpr int kRowsAtOnce = 4;  // rows whose sums are in registers together

/// Eliminates systems with some rows after those of the points.
/// @return the least pivot of each lane
Lanes eliminate_all(double** rows, int points, int all_rows) {
    Lanes least = all(1);
    for (int k = 0; k < points; ++k) {
        double* const pivot_row = rows[k];
        Lanes pivot = load(pivot_row + k * kLanes);
        for (int j = 0; j < k; ++j) {
            const Lanes factor = load(pivot_row + j * kLanes);
            pivot -= factor * factor;
        }
        least = pivot < least ? pivot : least;
        // A point that the nearer ones determine is passed over.
        const Lanes scale = pivot < kRedundantVariance
                                ? all(0)
                                : 1 / root(pivot < kRedundantVariance ? all(1) : pivot);
        int row = k + 1;
        for (; row + kRowsAtOnce <= all_rows; row += kRowsAtOnce)
            eliminate<kRowsAtOnce>(rows + row, pivot_row, k, scale);
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

/// Where the rows begin: those of the points, of growing length, then those of all points.
void find_rows(double** rows, double* numbers, int points, int all_rows) {
    for (int i = 0; i < points; ++i)
        rows[i] = numbers + (i * (i + 1) / 2) * kLanes;
    for (int i = points; i < all_rows; ++i)
        rows[i] = numbers + (points * (points + 1) / 2 + (i - points) * points) * kLanes;
}

void krige_lanes(int points, double* numbers, double* estimates, double* variances) {
    double* rows[kMostLanePoints + 3];
    find_rows(rows, numbers, points, points + 3);
    eliminate_all(rows, points, points + 3);
    Lanes uu = all(0), us = all(0), ut = all(0), ss = all(0), st = all(0);
    for (int k = 0; k < points; ++k) {
        const Lanes u = load(rows[points] + k * kLanes), s = load(rows[points + 1] + k * kLanes),
                    t = load(rows[points + 2] + k * kLanes);
        uu += u * u;
        us += u * s;
        ut += u * t;
        ss += s * s;
        st += s * t;
    }
    const EstimateOf<Lanes> estimate = ordinary_kriging(uu, us, ut, ss, st);
    store(estimates, estimate.value);
    store(variances, estimate.variance);
}

Lanes product(const double* a, const double* b, int points) {
    Lanes sum = all(0);
    for (int k = 0; k < points; ++k)
        sum += load(a + k * kLanes) * load(b + k * kLanes);
    return sum;
}

/// Makes vectors orthonormal, each against those before it (modified Gram-Schmidt); upper[b][a] is
/// the part of the a-th along the b-th.
/// @return the least share of a vector's square that is orthogonal to those before it
Lanes make_orthonormal(double* const* vectors, int terms, int points,
                       Lanes (*upper)[kMostLaneTerms]) {
    Lanes least = all(1);
    for (int a = 0; a < terms; ++a) {
        const Lanes whole = product(vectors[a], vectors[a], points);
        for (int b = 0; b < a; ++b) {
            const Lanes projection = product(vectors[b], vectors[a], points);
            upper[b][a] = projection;
            for (int k = 0; k < points; ++k) {
                store(vectors[a] + k * kLanes,
                      load(vectors[a] + k * kLanes) - projection * load(vectors[b] + k * kLanes));
            }
        }
        const Lanes left = product(vectors[a], vectors[a], points);
        const Lanes share = left / (whole > 0.0 ? whole : all(1));
        least = share < least ? share : least;
        upper[a][a] = root(left > 0.0 ? left : all(1));
        for (int k = 0; k < points; ++k)
            store(vectors[a] + k * kLanes, load(vectors[a] + k * kLanes) / upper[a][a]);
    }
    return least;
}

// The least share of a term's square orthogonal to the terms before it: less costs digits.
constexpr double kWellApart = 1e-6;

/// universal_kriging, with the terms (1, 0, ..) at the node.
void krige_lanes_about_drift(int points, int terms, double* numbers, double* estimates,
                             double* variances, double* well_posed) {
    double* rows[kMostLanePoints + 2 + kMostLaneTerms];
    find_rows(rows, numbers, points, points + 2 + terms);
    double* const* drift = rows + points + 1;
    Lanes upper[kMostLaneTerms][kMostLaneTerms];

    // Whether the points distinguish the terms is decided on the terms as they are.
    alignas(64) double plain[kMostLaneTerms * kMostLanePoints * kLanes];
    double* copies[kMostLaneTerms] = {};
    for (int a = 0; a < terms; ++a) {
        copies[a] = plain + a * kMostLanePoints * kLanes;
        for (int k = 0; k < points; ++k)
            store(copies[a] + k * kLanes, load(drift[a] + k * kLanes));
    }
    const Lanes apart = make_orthonormal(copies, terms, points, upper);

    const Lanes pivot = eliminate_all(rows, points, points + 2 + terms);
    const Lanes apart_then = make_orthonormal(drift, terms, points, upper);
    const double* const u = rows[points];
    const double* const t = rows[points + 1 + terms];
    Lanes estimate = product(u, t, points), variance = 1 - product(u, u, points);
    Lanes at_node[kMostLaneTerms];
    for (int a = 0; a < terms; ++a) {
        Lanes sum = all(a == 0 ? 1 : 0);
        for (int b = 0; b < a; ++b)
            sum -= upper[b][a] * at_node[b];
        at_node[a] = sum / upper[a][a];
        const Lanes open = at_node[a] - product(drift[a], u, points);
        estimate += open * product(drift[a], t, points);
        variance += open * open;
    }
    store(estimates, estimate);
    store(variances, variance > 0.0 ? variance : all(0));
    const Lanes worst = apart < apart_then ? apart : apart_then;
    store(well_posed, pivot < kRedundantVariance ? all(0) : worst < kWellApart ? all(0) : all(1));
}

void krige_about_drift(const LaneSystems& systems, double* estimates, double* variances,
                       double* well_posed) {
    for (int lane = 0; lane < kLanes; lane += LANES_WIDTH) {
        krige_lanes_about_drift(systems.points, systems.terms, systems.rows + lane,
                                estimates + lane, variances + lane, well_posed + lane);
    }
}

void krige(const LaneSystems& systems, double* estimates, double* variances) {
    for (int lane = 0; lane < kLanes; lane += LANES_WIDTH)
        krige_lanes(systems.points, systems.rows + lane, estimates + lane, variances + lane);
}

}  // namespace

extern const LaneKernels kernels;
const LaneKernels kernels{LANES_TEXT(LANES_NAME), &covariances, &add_scaled,
                          &differences,           &krige,       &krige_about_drift};

}  // namespace realmodel::interpolation::LANES_NAME

#if LANES_WIDTH == 2
namespace realmodel::interpolation {

namespace avx2 {
extern const LaneKernels kernels;
}
namespace avx512f {
extern const LaneKernels kernels;
}

std::span<const LaneKernels> lane_kernels() {
    static const std::vector<LaneKernels> usable = [] {
        std::vector<LaneKernels> supported;
#ifdef REALMODEL_WIDE_LANES
        if (__builtin_cpu_supports("avx512f")) supported.push_back(avx512f::kernels);
        if (__builtin_cpu_supports("avx2")) supported.push_back(avx2::kernels);
#endif
        supported.push_back(baseline::kernels);
        return supported;
    }();
    return usable;
}

}  // namespace realmodel::interpolation
#endif
