// SPDX-License-Identifier: GPL-3.0-or-later
// How a fault is divided by one that it ends at.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "arrangement/triangle_arrangement.hpp"
#include "arrangement/triangulate.hpp"
#include "base/algorithms.hpp"
#include "cutting/nearest_side.hpp"
#include "realmodel/base/errors.hpp"
#include "structures/structure_cutter.hpp"

namespace realmodel::structures {

using arrangement::TriangleArrangement;
using cutting::Position;
using exact::SpacePointId;
using spatial::bounding_box;

namespace {

constexpr double kAlike = 1e-9;  // areas, as a share of both

/// The area of a region, twice, and a point well inside of it: the middle of the largest of its
/// triangles.
std::pair<double, Position> measured(const exact::SpacePoints& points,
                                     const arrangement::Loops<SpacePointId>& loops,
                                     const Position& normal) {
    const arrangement::View view(normal);
    std::vector<Position> corners;
    std::vector<arrangement::Loop> seen;
    for (const auto& loop : loops) {
        arrangement::Loop& corners_seen = seen.emplace_back();
        for (const SpacePointId p : loop) {
            corners_seen.push_back(
                {static_cast<cutting::NodeId>(corners.size()), view(points.rounded(p))});
            corners.push_back(points.rounded(p));
        }
    }
    std::vector<std::array<arrangement::LoopCorner, 3>> triangles;
    arrangement::triangulate(seen, view.rounding(corners), triangles);
    double area = 0, largest = -1;
    Position middle{0, 0, 0};
    for (const auto& t : triangles) {
        const std::array at{corners[index(t[0].node)], corners[index(t[1].node)],
                            corners[index(t[2].node)]};
        const double size = length(polygon_normal(at));
        area += size;
        if (size <= largest) continue;
        largest = size;
        middle = middle_of(at[0], at[1], at[2]);
    }
    return {area, middle};
}

}  // namespace

BranchSides branch_sides(const StructureCutter& cutter, std::int32_t branch, std::int32_t other) {
    exact::SpacePoints points;
    TriangleArrangement arrangement(points);
    std::vector<std::size_t> triangles;  // of the cutter: the branch itself, then the other
    const auto add = [&](std::int32_t structure, bool with_continuation) {
        for (std::size_t t = 0; t < cutter.structure.size(); ++t) {
            if (cutter.structure[t] != structure ||
                (cutter.is_continuation[t] != 0 && !with_continuation))
                continue;
            const auto [a, b, c] = cutter.combined.corners(t);
            const std::array corners{points.add(a), points.add(b), points.add(c)};
            arrangement.add(corners);
            triangles.push_back(t);
        }
    };
    add(branch, false);
    const std::size_t branch_size = triangles.size();
    add(other, true);
    const auto boxes = transformed(
        triangles, [&](std::size_t t) { return bounding_box(cutter.combined.corners(t)); });
    const spatial::BoxTree tree(
        {boxes.begin() + static_cast<std::ptrdiff_t>(branch_size), boxes.end()});
    BranchSides sides;
    std::vector<TriangleArrangement::TriangleIntersection> meetings;
    for (std::size_t t = 0; t < branch_size; ++t) {
        std::vector<std::int32_t> near;
        tree.find(boxes[t], [&near](std::int32_t at) { near.push_back(at); });
        std::ranges::sort(near);
        for (const std::int32_t at : near) {
            const auto with = static_cast<std::int32_t>(branch_size) + at;
            const auto& corners = arrangement.corners(static_cast<std::int32_t>(t));
            const auto& others = arrangement.corners(with);
            const auto met = arrangement.intersection(static_cast<std::int32_t>(t), with);
            if (cutter.is_continuation[triangles[index(with)]] == 0)
                sides.meets = sides.meets || met ||
                              std::ranges::find_first_of(corners, others) != corners.end();
            if (met) meetings.push_back(*met);
        }
    }
    for (const auto& met : meetings)
        arrangement.insert(met);
    arrangement.divide({1, nullptr});
    assert(branch != other && branch_size <= triangles.size());
    const cutting::NearestSide nearest(cutter.single[index(other)]);
    const auto& regions = arrangement.regions();
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const arrangement::Region region = regions[r];
        if (index(region.triangle) >= branch_size) continue;
        std::array<Position, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = points.rounded(arrangement.corners(region.triangle)[i]);
        const auto [area, middle] = measured(points, region.loops, polygon_normal(corners));
        (nearest(middle) == cutting::kBelow ? sides.below : sides.above) += area;
    }
    return sides;
}

std::int8_t larger_side(const StructureCutter& cutter, std::int32_t branch, std::int32_t other) {
    const BranchSides sides = branch_sides(cutter, branch, other);
    if (std::min(sides.above, sides.below) == 0 && !sides.meets)
        throw InputError("does_not_meet", "the fault does not meet a fault that it is to end at",
                         branch, {other});
    if (std::abs(sides.above - sides.below) <= kAlike * (sides.above + sides.below))
        throw InputError("equal_halves", "the fault that it is to end at cuts it into two halves",
                         branch, {other});
    return sides.below > sides.above ? cutting::kBelow : cutting::kAbove;
}

}  // namespace realmodel::structures
