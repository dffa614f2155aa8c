// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "interpolation/data_points.hpp"
#include "interpolation/dsi/vectors.hpp"

namespace realmodel::interpolation {

/// A height somewhere on a mesh, or the rise of a triangle along a vector: met as well as its
/// weight says, exactly, or a bound. While it is active strength * (value(z) - height)^2 is added
/// to the roughness.
struct Constraint {
    enum class Kind { kWeighted, kEqual, kLeast, kMost };

    std::array<std::int32_t, 3> nodes;  ///< the first alone counts where the other weights are 0
    std::array<double, 3> weights;      ///< of sum 1, or 0 of a rise
    double strength;
    Kind kind;
    double height;
    bool of_node = false;   ///< and not of a point
    double multiplier = 0;  ///< of the augmented Lagrangian
    bool active = true;
    Position along{};  ///< the vector of a rise

    bool is_rise() const { return along != Position{}; }

    static Constraint at_node(std::size_t node, double strength, Kind kind, double height) {
        const auto number = static_cast<std::int32_t>(node);
        return {{number, number, number}, {1, 0, 0}, strength, kind, height, true};
    }

    /// How many of the nodes count.
    std::size_t corners() const { return weights[0] == 1 && !is_rise() ? 1 : 3; }

    double value(const Vector& z) const {
        if (corners() == 1) return z[nodes[0]];
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k)
            sum += weights[k] * z[nodes[k]];
        return sum;
    }
    /// The multiplier after a round that gave the heights z.
    double next_multiplier(const Vector& z) const {
        const double sum = multiplier + strength * (height - value(z));
        if (kind == Kind::kLeast) return std::max(0.0, sum);
        if (kind == Kind::kMost) return std::min(0.0, sum);
        return sum;
    }
    double violation(const Vector& z) const {
        const double below = height - value(z);
        if (kind == Kind::kLeast) return std::max(0.0, below);
        if (kind == Kind::kMost) return std::max(0.0, -below);
        return std::abs(below);
    }
    /// Of a rise the center of its triangle.
    Position position(std::span<const Position> of) const {
        Position sum{};
        if (is_rise()) {
            for (const std::int32_t node : nodes) {
                for (std::size_t axis = 0; axis < 2; ++axis)
                    sum[axis] += of[node][axis] / 3;
            }
            return sum;
        }
        for (std::size_t k = 0; k < corners(); ++k) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                sum[axis] += weights[k] * of[nodes[k]][axis];
        }
        return sum;
    }
};

}  // namespace realmodel::interpolation
