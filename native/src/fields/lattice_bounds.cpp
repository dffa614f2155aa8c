// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/lattice_bounds.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "fields/lattice_weights.hpp"

namespace realmodel::fields {

namespace {

constexpr int kProjectionRounds = 1000;
constexpr double kBeyond = 1e-9;  // of the range of the values: so that rounding keeps the bound

/// sign (the function at a place - a level) is not negative.
struct Half {
    std::array<std::size_t, 4> nodes;
    std::array<double, 4> weights;
    double sign, level, square;
};

}  // namespace

void keep_bounds(const Lattice& lattice, const FieldData& data, std::span<const char> kept,
                 std::span<const double> levels, std::vector<double>& values) {
    const Slits& slits = data.slits;
    std::vector<Half> halves;
    for (std::size_t n = 0; n < data.bounds.size(); ++n) {
        if (kept[n] == 0) continue;
        Half half{};
        const auto corners = corners_at(lattice, data.bounds[n]);
        const std::size_t first =
            slits.count > 0 ? static_cast<std::size_t>(slits.bound_sides[n]) * lattice.nodes() : 0;
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
        for (const Half& half : halves) {
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
