// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>

#include "interpolation/ties/tie_system.hpp"
#include "realmodel/interpolation/ties.hpp"
#include "spatial/mesh_locator.hpp"

namespace realmodel::interpolation {

namespace {

constexpr int kMostRounds = 5000;  // where data share two corners it takes many
constexpr double kOnEdge = 1e-9;   // weights of corners that do not count

/// That the sheet is so far above the least heights in a triangle.
struct AskedThickness {
    std::array<std::int32_t, 3> corners;
    std::array<double, 3> weights;
    double low, high;
};

class Thickness {
public:
    explicit Thickness(const RaisedSheet& sheet)
        : at_(sheet.nodes.size()), is_zero_(sheet.nodes.size(), 0) {
        for (std::size_t n = 0; n < at_.size(); ++n)
            at_[n] = sheet.heights[n] - sheet.least[n];
    }

    double at(std::size_t node) const { return at_[node]; }
    double of(const AskedThickness& asked) const {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k)
            sum += asked.weights[k] * at_[asked.corners[k]];
        return sum;
    }
    /// No thickness at these corners for good, so that there is none in their triangle.
    /// @return whether that changes anything
    bool make_zero(const AskedThickness& asked) {
        bool any = false;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t node = asked.corners[k];
            if (asked.weights[k] <= kOnEdge) continue;
            any = any || at_[node] != 0;
            is_zero_[node] = 1;
            at_[node] = 0;
        }
        return any;
    }
    /// The nearest thicknesses that are as asked for, but none is negative.
    /// @return whether that changes anything
    bool project(const AskedThickness& asked) {
        std::array<double, 3> share{};
        double squares = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (is_zero_[asked.corners[k]] == 0) share[k] = asked.weights[k];
            squares += share[k] * share[k];
        }
        if (squares <= kOnEdge) return false;
        const double current = of(asked);
        const double step = (std::clamp(current, asked.low, asked.high) - current) / squares;
        bool any = false;
        for (std::size_t k = 0; k < 3; ++k) {
            double& thickness = at_[asked.corners[k]];
            const double moved = std::max(thickness + share[k] * step, 0.0);
            any = any || moved != thickness;
            thickness = moved;
        }
        return any;
    }

private:
    std::vector<double> at_;
    std::vector<char> is_zero_;
};

std::vector<AskedThickness> asked_of(const RaisedSheet& sheet, const TieData& data,
                                     std::span<const double> margins) {
    const spatial::MeshLocator locator(sheet.nodes, sheet.triangles);
    std::vector<AskedThickness> out;
    for (std::size_t n = 0; n < data.places.size(); ++n) {
        const auto location = locator.find(data.places[n]);
        if (!location) continue;
        AskedThickness asked{sheet.triangles[static_cast<std::size_t>(location->triangle)],
                             location->weights, 0, 0};
        double base = 0;
        for (std::size_t k = 0; k < 3; ++k)
            base += asked.weights[k] * sheet.least[asked.corners[k]];
        if (std::isnan(base)) continue;
        asked.high = std::max(data.upper[n] + margins[n] - base, 0.0);
        asked.low = std::min(data.lower[n] - margins[n] - base, asked.high);
        out.push_back(asked);
    }
    return out;
}

/// The thickness with which what is asked for is met, or as much of it as can be.
Thickness met(const RaisedSheet& sheet, std::span<const AskedThickness> every, double tolerance,
              const Execution& execution) {
    Thickness thickness(sheet);
    bool any = true;  // until all hold, or the others never will
    for (int round = 0; round < kMostRounds && any; ++round) {
        if (execution.progress != nullptr) execution.progress->check();
        any = false;
        for (const AskedThickness& asked : every) {
            const double current = thickness.of(asked);
            if (current >= asked.low - tolerance && current <= asked.high + tolerance) continue;
            if (asked.high <= tolerance) any = thickness.make_zero(asked) || any;
            any = thickness.project(asked) || any;
        }
    }
    return thickness;
}

/// The range of the finite heights of a sheet and its data.
double range_of(const RaisedSheet& sheet, const TieData& data) {
    DataRange range;
    for (const auto& heights : {sheet.heights, data.lower, data.upper})
        std::ranges::for_each(heights, [&](double z) { range.add(z); });
    return range.size();
}

/// Leaves out what lifts a node by more than `most`: others hold the nodes beside it down.
/// @return whether anything is
bool leave_out_far(const RaisedSheet& sheet, const Thickness& thickness, double most,
                   double tolerance, std::vector<AskedThickness>& every) {
    const auto lifts_far = [&](const AskedThickness& asked) {
        return std::ranges::any_of(asked.corners, [&](std::int32_t corner) {
            const auto n = static_cast<std::size_t>(corner);
            return thickness.at(n) - (sheet.heights[n] - sheet.least[n]) > most;
        });
    };
    const auto is_tight = [&](const AskedThickness& asked) {
        return thickness.of(asked) <= asked.low + tolerance;
    };
    if (std::erase_if(every, [&](const auto& goal) { return lifts_far(goal) && is_tight(goal); }))
        return true;
    return std::erase_if(every, lifts_far) > 0;
}

}  // namespace

std::vector<double> raised_heights(const RaisedSheet& sheet, const TieData& data,
                                   std::span<const double> margins, double tolerance,
                                   const Execution& execution) {
    std::vector<AskedThickness> every = asked_of(sheet, data, margins);
    const double most = range_of(sheet, data);
    Thickness thickness = met(sheet, every, tolerance, execution);
    while (leave_out_far(sheet, thickness, most, tolerance, every))
        thickness = met(sheet, every, tolerance, execution);
    std::vector<double> out(sheet.heights.begin(), sheet.heights.end());
    for (const AskedThickness& asked : every) {
        for (const std::int32_t corner : asked.corners) {
            const auto n = static_cast<std::size_t>(corner);
            if (thickness.at(n) != sheet.heights[n] - sheet.least[n])
                out[n] = sheet.least[n] + thickness.at(n);
            assert(!(out[n] < sheet.least[n]) || out[n] == sheet.heights[n]);
        }
    }
    return out;
}

}  // namespace realmodel::interpolation
