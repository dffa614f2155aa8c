// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/mesh_locator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "exact/orient2d.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

void check_mesh(std::span<const Place> vertices, std::span<const MeshLocator::Triangle> triangles) {
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (std::isfinite(vertices[v][0]) && std::isfinite(vertices[v][1])) continue;
        throw InputError("not_finite", "vertex " + std::to_string(v) + " is not finite", -1,
                         {static_cast<std::int64_t>(v)});
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::int32_t v : triangles[t]) {
            if (v >= 0 && static_cast<std::size_t>(v) < vertices.size()) continue;
            throw InputError("bad_index",
                             "triangle " + std::to_string(t) + " names a vertex that is not there",
                             -1, {static_cast<std::int64_t>(t)});
        }
    }
}

}  // namespace

MeshLocator::MeshLocator(std::span<const Place> vertices, std::span<const Triangle> triangles)
    : vertices_(vertices), triangles_(triangles) {
    check_mesh(vertices, triangles);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    low_ = {infinity, infinity};
    high_ = {-infinity, -infinity};
    for (const Triangle& triangle : triangles) {
        for (const std::int32_t v : triangle) {
            for (std::size_t axis = 0; axis < 2; ++axis) {
                const double c = vertices[static_cast<std::size_t>(v)][axis];
                low_[axis] = std::min(low_[axis], c);
                high_[axis] = std::max(high_[axis], c);
            }
        }
    }
    const double width = high_[0] - low_[0], height = high_[1] - low_[1];
    if (width > 0 && height > 0) {
        // About as many cells as triangles, as square as can be.
        const double side = std::sqrt(width * height / static_cast<double>(triangles.size()));
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double extent = high_[axis] - low_[axis];
            const double most = 2 * static_cast<double>(triangles.size());
            cells_[axis] = static_cast<std::size_t>(std::clamp(extent / side, 1.0, most));
            step_[axis] = extent / static_cast<double>(cells_[axis]);
        }
    }
    const auto for_cells = [&](const Triangle& triangle, auto&& visit) {
        std::array<std::size_t, 2> from{}, to{};
        for (int axis = 0; axis < 2; ++axis) {
            double least = infinity, most = -infinity;
            for (const std::int32_t v : triangle) {
                const double c = vertices_[static_cast<std::size_t>(v)][axis];
                least = std::min(least, c);
                most = std::max(most, c);
            }
            from[axis] = cell(least, axis);
            to[axis] = cell(most, axis);
        }
        for (std::size_t j = from[1]; j <= to[1]; ++j) {
            for (std::size_t i = from[0]; i <= to[0]; ++i)
                visit(j * cells_[0] + i);
        }
    };
    first_.assign(cells_[0] * cells_[1] + 1, 0);
    for (const Triangle& triangle : triangles)
        for_cells(triangle, [&](std::size_t c) { ++first_[c + 1]; });
    for (std::size_t c = 1; c < first_.size(); ++c)
        first_[c] += first_[c - 1];
    held_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for_cells(triangles[t],
                  [&](std::size_t c) { held_[next[c]++] = static_cast<std::int32_t>(t); });
    }
}

std::size_t MeshLocator::cell(double coordinate, int axis) const {
    // The same rounding for triangles and places, and monotone: a place finds its triangle.
    const double share =
        (coordinate - low_[static_cast<std::size_t>(axis)]) / step_[static_cast<std::size_t>(axis)];
    const std::size_t last = cells_[static_cast<std::size_t>(axis)] - 1;
    return share > 0 ? std::min(last, static_cast<std::size_t>(share)) : 0;
}

std::optional<MeshLocator::Found> MeshLocator::find(const Place& place) const {
    if (!(place[0] >= low_[0] && place[0] <= high_[0] && place[1] >= low_[1] &&
          place[1] <= high_[1])) {
        return std::nullopt;
    }
    const std::size_t c = cell(place[1], 1) * cells_[0] + cell(place[0], 0);
    for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) {
        const Triangle& triangle = triangles_[static_cast<std::size_t>(held_[k])];
        std::array<Place, 3> corner;
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = vertices_[static_cast<std::size_t>(triangle[i])];
        const int way = exact::orient2d(corner[0], corner[1], corner[2]);
        if (way == 0 || exact::orient2d(corner[0], corner[1], place) == -way ||
            exact::orient2d(corner[1], corner[2], place) == -way ||
            exact::orient2d(corner[2], corner[0], place) == -way) {
            continue;
        }
        Found found{held_[k], {}};
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Place &a = corner[(i + 1) % 3], &b = corner[(i + 2) % 3];
            const double area =
                (a[0] - place[0]) * (b[1] - place[1]) - (b[0] - place[0]) * (a[1] - place[1]);
            found.weights[i] = std::max(0.0, way * area);
            sum += found.weights[i];
        }
        if (!(sum > 0)) {  // an area lost to rounding
            found.weights = {1, 0, 0};
            return found;
        }
        for (double& weight : found.weights)
            weight /= sum;
        return found;
    }
    return std::nullopt;
}

std::vector<double> heights_on_surface(std::span<const std::array<double, 3>> vertices,
                                       std::span<const std::array<std::int32_t, 3>> triangles,
                                       std::span<const std::array<double, 2>> nodes, int threads,
                                       Progress* progress) {
    require_finite_nodes(nodes);
    std::vector<Place> places;
    places.reserve(vertices.size());
    for (const auto& [x, y, z] : vertices)
        places.push_back({x, y});
    const MeshLocator locator(places, triangles);
    std::vector<double> z(nodes.size());
    const NodeLoop loop{nodes.size(), 1024, threads, progress};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t i) {
                        const auto found = locator.find(nodes[i]);
                        if (!found) {
                            z[i] = std::numeric_limits<double>::quiet_NaN();
                            return;
                        }
                        const auto& corners = triangles[static_cast<std::size_t>(found->triangle)];
                        // From the first corner: heights far from 0 lose no digits, a flat triangle
                        // is flat.
                        const double base = vertices[static_cast<std::size_t>(corners[0])][2];
                        z[i] = base;
                        for (std::size_t k = 1; k < 3; ++k)
                            z[i] += found->weights[k] *
                                    (vertices[static_cast<std::size_t>(corners[k])][2] - base);
                    });
    return z;
}

}  // namespace realmodel::interpolation
