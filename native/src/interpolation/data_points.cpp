// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/data_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

// Squares of larger numbers overflow.
bool usable(double number) {
    return std::abs(number) < 1e150;
}

[[noreturn]] void refuse_contradiction(std::span<const std::array<double, 3>> points,
                                       std::int32_t first, std::int32_t second) {
    const auto& a = points[first];
    const auto& b = points[second];
    char text[200];
    std::snprintf(text, sizeof text,
                  "points %d and %d lie at one place (%.12g, %.12g) but have the values %.12g and "
                  "%.12g; remove one of them",
                  first, second, a[0], a[1], a[2], b[2]);
    throw InputError("contradicting_points", text, -1, {first, second}, a);
}

}  // namespace

DataPoints prepare_points(std::span<const std::array<double, 3>> points) {
    if (points.empty()) throw InputError("no_points", "there are no points to interpolate from");
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::all_of(points[i].begin(), points[i].end(), usable)) continue;
        throw InputError("not_finite",
                         "point " + std::to_string(i) + " is not a finite number below 1e150", -1,
                         {static_cast<std::int64_t>(i)});
    }
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        for (int axis = 0; axis < 2; ++axis) {
            if (points[a][axis] != points[b][axis]) return points[a][axis] < points[b][axis];
        }
        return a < b;
    });
    std::vector<std::int32_t> first_at(points.size());  // of each point, the first at its place
    std::int32_t first = order[0];
    first_at[first] = first;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const auto &a = points[first], &b = points[order[i]];
        if (a[0] != b[0] || a[1] != b[1]) {
            first = order[i];
        } else if (a[2] != b[2]) {
            refuse_contradiction(points, first, order[i]);
        }
        first_at[order[i]] = first;
    }
    DataPoints data;
    data.origin = {points[0][0], points[0][1]};
    data.place_of.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (first_at[i] != static_cast<std::int32_t>(i)) {
            data.place_of[i] = data.place_of[first_at[i]];
            continue;
        }
        data.place_of[i] = static_cast<std::int32_t>(data.places.size());
        data.places.push_back({points[i][0], points[i][1]});
        data.local.push_back(data.to_local(data.places.back()));
        data.values.push_back(points[i][2]);
    }
    return data;
}

void require_finite_nodes(std::span<const Place> nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (usable(nodes[i][0]) && usable(nodes[i][1])) continue;
        throw InputError("not_finite",
                         "node " + std::to_string(i) + " is not a finite number below 1e150", -1,
                         {static_cast<std::int64_t>(i)});
    }
}

}  // namespace realmodel::interpolation
