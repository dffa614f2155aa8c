// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/data_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "base/algorithms.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

[[noreturn]] void refuse_contradiction(std::span<const std::array<double, 3>> points,
                                       std::int32_t first, std::int32_t second) {
    const auto& a = points[first];
    const auto& b = points[second];
    char text[200];
    std::snprintf(
        text, sizeof text,
        "two points have the same position in plan (%.12g, %.12g) but the values %.12g and "
        "%.12g; remove one of them",
        a[0], a[1], a[2], b[2]);
    throw InputError("contradicting_points", text, -1, {first, second}, a);
}

}  // namespace

bool usable(double number) {
    return std::abs(number) < 1e150;
}

void require_usable(std::span<const double> numbers, const char* what, std::size_t i) {
    if (std::ranges::all_of(numbers, usable)) return;
    throw InputError(
        "not_finite",
        std::string(what) + " " + std::to_string(i) + " is not a finite number below 1e150", -1,
        {static_cast<std::int64_t>(i)});
}

std::vector<double> DataPoints::for_input_points(std::span<const double> point_values) const {
    std::vector<double> out(number_of.size());
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = point_values[number_of[i]];
    return out;
}

DataPoints prepare_points(std::span<const std::array<double, 3>> points,
                          std::span<const std::int32_t> sheets) {
    if (points.empty()) throw InputError("no_points", "there are no points to interpolate from");
    require_countable(points.size(), "points");
    for (std::size_t i = 0; i < points.size(); ++i)
        require_usable(points[i], "point", i);
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto sheet = [&](std::int32_t i) { return sheets.empty() ? 0 : sheets[i]; };
    const auto position = [&](std::int32_t i) {
        return std::tuple(points[i][0], points[i][1], sheet(i));
    };
    std::ranges::sort(order, {}, [&](std::int32_t i) { return std::pair(position(i), i); });
    std::vector<std::int32_t> first_at(points.size());  // of each point, the first at its position
    for (const auto group : groups_of(order, position)) {
        for (const std::int32_t i : group) {
            if (points[i][2] != points[group[0]][2]) refuse_contradiction(points, group[0], i);
            first_at[i] = group[0];
        }
    }
    DataPoints data;
    data.origin = {points[0][0], points[0][1]};
    data.number_of.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::cmp_not_equal(first_at[i], i)) {
            data.number_of[i] = data.number_of[first_at[i]];
            continue;
        }
        data.number_of[i] = static_cast<std::int32_t>(data.local.size());
        data.local.push_back(data.to_local({points[i][0], points[i][1]}));
        data.values.push_back(points[i][2]);
        if (!sheets.empty()) data.sheets.push_back(sheets[i]);
    }
    return data;
}

std::vector<std::int32_t> even_subset(std::size_t count, std::size_t most) {
    std::vector<std::int32_t> subset(std::min(count, most));
    for (std::size_t k = 0; k < subset.size(); ++k)
        subset[k] = static_cast<std::int32_t>(k * count / subset.size());
    return subset;
}

void require_finite_nodes(std::span<const PlanPosition> nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
        require_usable(nodes[i], "node", i);
}

void require_countable(std::size_t count, const char* what) {
    constexpr std::size_t kMost = INT32_MAX;
    if (count <= kMost) return;
    throw InputError("too_large", "there are " + std::to_string(count) + " " + what + "; at most " +
                                      std::to_string(kMost) + " can be used");
}

}  // namespace realmodel::interpolation
