// SPDX-License-Identifier: GPL-3.0-or-later
// Ordinary kriging as textbooks write it, with gamma and a full matrix: what the tests compare
// with.
#pragma once

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

using Points = std::vector<std::array<double, 3>>;
using Nodes = std::vector<std::array<double, 2>>;

/// gamma between two positions, written out anew.
inline double dense_gamma(const Variogram& v, double dx, double dy) {
    if (dx == 0 && dy == 0) return 0;
    const double azimuth = v.anisotropy.azimuth * std::numbers::pi / 180;
    const double along = dx * std::sin(azimuth) + dy * std::cos(azimuth);
    const double across = dx * std::cos(azimuth) - dy * std::sin(azimuth);
    const double minor = v.range / v.anisotropy.ratio;
    const double t = std::hypot(along / v.range, across / minor);
    double f = 0;
    switch (v.model) {
        case VariogramModel::kSpherical:
            f = t < 1 ? 1.5 * t - 0.5 * t * t * t : 1;
            break;
        case VariogramModel::kExponential:
            f = 1 - std::exp(-3 * t);
            break;
        case VariogramModel::kGaussian:
            f = 1 - std::exp(-3 * t * t);
            break;
        case VariogramModel::kCubic:
            f = t < 1 ? 7 * std::pow(t, 2) - 8.75 * std::pow(t, 3) + 3.5 * std::pow(t, 5) -
                            0.75 * std::pow(t, 7)
                      : 1;
            break;
        case VariogramModel::kMatern32: {
            const double a = 4.743864518390579;
            f = 1 - (1 + a * t) * std::exp(-a * t);
            break;
        }
        case VariogramModel::kMatern52: {
            const double b = 5.918649346310188;
            f = 1 - (1 + b * t + b * b * t * t / 3) * std::exp(-b * t);
            break;
        }
        case VariogramModel::kWave: {
            const double h = std::hypot(along, across) / v.range;
            f = 1 - std::cos(2 * std::numbers::pi * across / minor) * std::exp(-3 * h * h);
            break;
        }
    }
    return v.nugget + (v.sill - v.nugget) * f;
}

/// z and variance at a node from its `count` nearest points.
inline std::pair<double, double> dense_kriging(const Points& points,
                                               const std::array<double, 2>& node,
                                               const Variogram& v, std::size_t count) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto squared = [&](std::size_t i) {
        const double dx = points[i][0] - node[0], dy = points[i][1] - node[1];
        return dx * dx + dy * dy;
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return squared(a) < squared(b); });
    order.resize(std::min(count, order.size()));
    const auto n = static_cast<Eigen::Index>(order.size());
    Eigen::MatrixXd system = Eigen::MatrixXd::Ones(n + 1, n + 1);
    Eigen::VectorXd right = Eigen::VectorXd::Ones(n + 1);
    system(n, n) = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto& p = points[order[static_cast<std::size_t>(i)]];
        right(i) = dense_gamma(v, p[0] - node[0], p[1] - node[1]);
        for (Eigen::Index j = 0; j < n; ++j) {
            const auto& q = points[order[static_cast<std::size_t>(j)]];
            system(i, j) = dense_gamma(v, p[0] - q[0], p[1] - q[1]);
        }
    }
    const Eigen::VectorXd weights = system.partialPivLu().solve(right);
    double z = 0;
    for (Eigen::Index i = 0; i < n; ++i)
        z += weights(i) * points[order[static_cast<std::size_t>(i)]][2];
    return {z, weights.dot(right)};
}

/// Scattered points on gentle hills, x and y in 0 .. size from an origin.
inline Points hills(int count, double size, std::array<double, 2> origin = {0, 0},
                    unsigned seed = 1) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    Points points;
    for (int i = 0; i < count; ++i) {
        const double x = uniform(), y = uniform();
        points.push_back({origin[0] + size * x, origin[1] + size * y,
                          500 + 20 * std::sin(5 * x) * std::cos(4 * y) + 3 * x});
    }
    return points;
}

inline Nodes scattered_nodes(int count, double size, std::array<double, 2> origin = {0, 0},
                             unsigned seed = 2) {
    Nodes nodes;
    for (const auto& p : hills(count, size, origin, seed))
        nodes.push_back({p[0], p[1]});
    return nodes;
}

}  // namespace realmodel::interpolation
