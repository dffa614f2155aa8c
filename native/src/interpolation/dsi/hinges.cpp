// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/hinges.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"

namespace realmodel::interpolation {

using realmodel::dot;

namespace {

using Triangle = std::array<std::int32_t, 3>;

constexpr double kFlat = 1e-12;  // of the squared edge: triangles of less area have no slope

/// A side of a triangle, in the group of the lower of its ends.
struct Side {
    std::int32_t high_end, opposite, triangle;
};

/// Height of p over the line from a to b, and where its foot divides a to b.
struct Foot {
    double height, share;
};
Foot foot(const Position& a, const Position& b, const Position& p) {
    const Position u = minus(b, a), v = minus(p, a);
    return {std::abs(cross(u, v)) / length(u), dot(u, v) / dot(u, u)};
}

bool has_area(const Position& a, const Position& b, const Position& c) {
    const Position u = minus(b, a), v = minus(c, a);
    const double longest = std::max({dot(u, u), dot(v, v), squared_distance(u, v)});
    return std::abs(cross(u, v)) > kFlat * longest;
}

Hinge hinge(std::span<const Position> nodes, const std::array<std::int32_t, 4>& of) {
    const auto at = [&](int k) { return nodes[of[k]]; };
    const Position a = at(0), b = at(1), c = at(2), d = at(3);
    const double length = distance(a, b);
    const Foot left = foot(a, b, c), right = foot(a, b, d);
    // L^2 / (A + B), and the areas are L h / 2.
    const double scale = std::sqrt(2 * length / (left.height + right.height));
    Hinge out{of,
              {-scale * ((1 - left.share) / left.height + (1 - right.share) / right.height),
               -scale * (left.share / left.height + right.share / right.height),
               scale / left.height, scale / right.height},
              {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2},
              {}};
    for (int k = 0; k < 4; ++k) {
        const double x = at(k)[0] - out.middle[0], y = at(k)[1] - out.middle[1];
        out.bending[0] += out.g[k] * x * x / 2;
        out.bending[1] += out.g[k] * x * y;
        out.bending[2] += out.g[k] * y * y / 2;
    }
    return out;
}

}  // namespace

std::vector<Hinge> hinges(std::span<const Position> nodes, std::span<const Triangle> triangles) {
    auto by_low_end = bucketize<Side>(nodes.size(), [&](const auto& visit) {
        for (std::size_t number = 0; number < triangles.size(); ++number) {
            const Triangle& t = triangles[number];
            if (!has_area(nodes[t[0]], nodes[t[1]], nodes[t[2]])) continue;
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
                visit(low, Side{high, t[(k + 2) % 3], static_cast<std::int32_t>(number)});
            }
        }
    });
    std::vector<Hinge> out;
    out.reserve(by_low_end.values.size() / 2);
    std::vector<char> hinged(triangles.size(), 0);
    for (std::size_t v = 0; v < nodes.size(); ++v) {
        const std::span<Side> sides = by_low_end[v];
        std::ranges::stable_sort(sides, {}, &Side::high_end);
        for (std::size_t i = 1; i < sides.size(); ++i) {
            const Side &one = sides[i - 1], &other = sides[i];
            // Else a border, or one triangle given twice.
            if (one.high_end != other.high_end || one.opposite == other.opposite) continue;
            out.push_back(hinge(
                nodes, {static_cast<std::int32_t>(v), one.high_end, one.opposite, other.opposite}));
            hinged[one.triangle] = hinged[other.triangle] = 1;
        }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        if (hinged[t] == 0) out.push_back({{a, b, c, c}, {}, nodes[a], {}});
    }
    return out;
}

}  // namespace realmodel::interpolation
