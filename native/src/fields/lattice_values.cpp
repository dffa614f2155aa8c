// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/lattice_values.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "base/parallel.hpp"

namespace realmodel::fields {

namespace {

constexpr std::size_t kLarge = 200000;  // nodes
constexpr int kLeastCount = 8;          // along an axis that is halved
/// Second differences count up to so many times the first ones: beyond this a function is rough,
/// and the error that is taken from it would make new extremes.
constexpr double kMostBend = 3;

using Counts = std::array<int, 3>;

/// Cubic interpolation at half of a step beyond sample i of n, at `step` from one to the next.
double halfway(const double* samples, std::ptrdiff_t step, int i, int n) {
    if (i == 0) {
        return (5 * samples[0] + 15 * samples[step] - 5 * samples[2 * step] + samples[3 * step]) /
               16;
    }
    const double* const at = samples + i * step;
    if (i == n - 2) return (5 * at[step] + 15 * at[0] - 5 * at[-step] + at[-2 * step]) / 16;
    return (9 * (at[0] + at[step]) - (at[-step] + at[2 * step])) / 16;
}

/// Twice as dense along an axis: n samples become `count`, which is 2 n - 1, or less by one.
std::vector<double> refined(const std::vector<double>& from, Counts& counts, std::size_t axis,
                            int count, const Execution& execution) {
    std::size_t step = 1;
    for (std::size_t k = 0; k < axis; ++k)
        step *= static_cast<std::size_t>(counts[k]);
    const int n = counts[axis];
    assert(n >= 4 && (count == 2 * n - 1 || count == 2 * n - 2));
    const std::size_t run = step * static_cast<std::size_t>(n);
    const std::size_t to_run = step * static_cast<std::size_t>(count);
    const std::size_t lines = from.size() / static_cast<std::size_t>(n);
    counts[axis] = count;
    std::vector<double> to(lines * static_cast<std::size_t>(count));
    // Lines along the axis: `step` of them begin in each run.
    parallel_ranges(
        lines, 1024, execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t line = begin; line < end; ++line) {
                const double* const samples = &from[line / step * run + line % step];
                double* const out = &to[line / step * to_run + line % step];
                for (int i = 0; i < count; ++i) {
                    out[static_cast<std::size_t>(i) * step] =
                        i % 2 == 0 ? samples[static_cast<std::size_t>(i / 2) * step]
                                   : halfway(samples, static_cast<std::ptrdiff_t>(step), i / 2, n);
                }
            }
        },
        0.1);
    return to;
}

}  // namespace

std::vector<double> lattice_values(
    const Lattice& lattice,
    const std::function<void(std::span<const Vec3>, std::span<double>)>& values_at,
    const Execution& execution, bool is_smooth) {
    Lattice sampled = lattice;
    if (is_smooth && lattice.nodes() > kLarge) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (lattice.counts[axis] < kLeastCount) continue;
            sampled.spacing[axis] *= 2;
            sampled.counts[axis] = lattice.counts[axis] / 2 + 1;
        }
    }
    std::vector<double> values(sampled.nodes());
    parallel_ranges(
        values.size(), 512, execution,
        [&](std::size_t from, std::size_t to) {
            std::vector<Vec3> at(to - from);
            const auto nx = static_cast<std::size_t>(sampled.counts[0]);
            const auto ny = static_cast<std::size_t>(sampled.counts[1]);
            for (std::size_t n = from; n < to; ++n) {
                at[n - from] =
                    sampled.position(static_cast<int>(n % nx), static_cast<int>(n / nx % ny),
                                     static_cast<int>(n / nx / ny));
            }
            values_at(at, std::span<double>(values.data() + from, to - from));
        },
        0.9);
    Counts counts = sampled.counts;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (counts[axis] != lattice.counts[axis])
            values = refined(values, counts, axis, lattice.counts[axis], execution);
    }
    assert(counts == lattice.counts && values.size() == lattice.nodes());
    return values;
}

std::vector<double> balanced(const std::vector<double>& values, const Lattice& lattice,
                             const Execution& execution) {
    const Counts& counts = lattice.counts;
    // On a tetrahedron the error is half of the sum of w_a w_b d_ab^T H d_ab over its edges d_ab,
    // with weights w whose products are 1/20 in the mean. Over the six of a cell these are second
    // differences along x, y, z and the diagonal.
    std::vector<double> out = values;
    if (*std::ranges::min_element(counts) < 3) return out;
    const auto nx = static_cast<std::ptrdiff_t>(counts[0]);
    const auto ny = static_cast<std::ptrdiff_t>(counts[1]);
    const std::array steps{std::ptrdiff_t{1}, nx, nx * ny, 1 + nx + nx * ny};
    parallel_ranges(
        values.size(), 4096, execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) {
                const auto node = static_cast<std::ptrdiff_t>(n);
                // at the border those of the next node inside
                const std::ptrdiff_t i = std::clamp<std::ptrdiff_t>(node % nx, 1, counts[0] - 2);
                const std::ptrdiff_t j =
                    std::clamp<std::ptrdiff_t>(node / nx % ny, 1, counts[1] - 2);
                const std::ptrdiff_t k =
                    std::clamp<std::ptrdiff_t>(node / (nx * ny), 1, counts[2] - 2);
                const double* const at = &values[static_cast<std::size_t>(i + nx * (j + ny * k))];
                double sum = 0, rise = 0;
                for (const std::ptrdiff_t step : steps) {
                    sum += at[step] - 2 * at[0] + at[-step];
                    rise = std::max(rise, std::abs(at[step] - at[-step]) / 2);
                }
                const double most = kMostBend * rise;
                out[n] -= std::clamp(sum, -most, most) / 24;
            }
        },
        0.0);
    return out;
}

namespace {

constexpr int kProjectionRounds = 1000;
constexpr double kBeyond = 1e-9;  // of the range of the values: so that rounding keeps the bound

/// sign (the function at a place - a level) is not negative.
struct HalfSpace {
    std::array<std::size_t, 4> nodes;
    std::array<double, 4> weights;
    double sign, level, square;
};

}  // namespace

void keep_bounds(const Lattice& lattice, const FieldData& data, std::span<const char> is_held,
                 std::span<const double> levels, std::vector<double>& values) {
    const Slits& slits = data.slits;
    std::vector<HalfSpace> halves;
    for (std::size_t n = 0; n < data.bounds.size(); ++n) {
        if (is_held[n] == 0) continue;
        HalfSpace half{};
        const auto corners = corners_at(lattice, data.bounds[n]);
        const std::size_t first =
            slits.count > 0
                ? static_cast<std::size_t>(slits.bound_combinations[n]) * lattice.nodes()
                : 0;
        for (std::size_t c = 0; c < 4; ++c) {
            half.nodes[c] = first + corners[c].first;
            if (!slits.same.empty())
                half.nodes[c] = static_cast<std::size_t>(slits.same[half.nodes[c]]);
            half.weights[c] = corners[c].second;
            half.square += half.weights[c] * half.weights[c];
        }
        for (const double sign : {1.0, -1.0}) {
            const std::int32_t surface = sign > 0 ? data.bound_below[n] : data.bound_above[n];
            if (surface < 0) continue;
            half.sign = sign;
            half.level = levels[static_cast<std::size_t>(surface)];
            halves.push_back(half);
        }
    }
    if (halves.empty()) return;
    const auto [low, high] = std::ranges::minmax(values);
    const double beyond = kBeyond * (high - low);
    for (int round = 0; round < kProjectionRounds; ++round) {
        bool any = false;
        for (const HalfSpace& half : halves) {
            double at = 0;
            for (std::size_t c = 0; c < 4; ++c)
                at += half.weights[c] * values[half.nodes[c]];
            const double above = half.sign * (at - half.level);
            if (above >= 0) continue;
            any = true;
            const double step = half.sign * (beyond - above) / half.square;
            for (std::size_t c = 0; c < 4; ++c)
                values[half.nodes[c]] += step * half.weights[c];
        }
        if (!any) return;
    }
}

}  // namespace realmodel::fields
