// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/mesh_locator.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/checked_indices.hpp"
#include "base/index.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::spatial {

namespace {

void check_mesh(std::span<const PlanPosition> vertices,
                std::span<const MeshLocator::Triangle> triangles) {
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (std::isfinite(vertices[v][0]) && std::isfinite(vertices[v][1])) continue;
        throw InputError("not_finite", "vertex " + std::to_string(v) + " is not finite", -1,
                         {static_cast<std::int64_t>(v)});
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        require_vertices("triangle", t, triangles[t], vertices.size());
}

}  // namespace

MeshLocator::MeshLocator(std::span<const PlanPosition> vertices,
                         std::span<const Triangle> triangles, const PlanBox& asked)
    : vertices_(vertices), triangles_(triangles) {
    check_mesh(vertices, triangles);
    std::vector<PlanBox> boxes;
    std::vector<std::int32_t> near;
    PlanBox frame = kNoBox;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const PlanBox box = box_around(corners_of(triangles[t]));
        if (!box.meets(asked)) continue;
        boxes.push_back(box);
        near.push_back(static_cast<std::int32_t>(t));
        frame = frame.united(box);
    }
    tiles_ = PlanTiles(frame, near.size());
    triangles_at_ = bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
        for (std::size_t i = 0; i < near.size(); ++i) {
            tiles_.for_each(tiles_.span(boxes[i]), [&](std::size_t tile) { put(tile, near[i]); });
        }
    });
}

std::array<PlanPosition, 3> MeshLocator::corners_of(const Triangle& triangle) const {
    return {vertices_[index(triangle[0])], vertices_[index(triangle[1])],
            vertices_[index(triangle[2])]};
}

std::optional<MeshLocator::BarycentricPosition> MeshLocator::find(
    const PlanPosition& position) const {
    if (!tiles_.frame().contains(position)) return std::nullopt;
    for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
        const std::array<PlanPosition, 3> corner = corners_of(triangles_[index(t)]);
        const int way = exact::orient2d(corner[0], corner[1], corner[2]);
        if (way == 0 || exact::orient2d(corner[0], corner[1], position) == -way ||
            exact::orient2d(corner[1], corner[2], position) == -way ||
            exact::orient2d(corner[2], corner[0], position) == -way) {
            continue;
        }
        BarycentricPosition barycentric{t, {}};
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double area = twice_area(position, corner[(i + 1) % 3], corner[(i + 2) % 3]);
            barycentric.weights[i] = std::max(0.0, way * area);
            sum += barycentric.weights[i];
        }
        if (!(sum > 0)) {  // an area lost to rounding
            barycentric.weights = {1, 0, 0};
            return barycentric;
        }
        for (double& weight : barycentric.weights)
            weight /= sum;
        return barycentric;
    }
    return std::nullopt;
}

}  // namespace realmodel::spatial
