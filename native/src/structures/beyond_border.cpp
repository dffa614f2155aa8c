// SPDX-License-Identifier: GPL-3.0-or-later
// Where a fault goes on beyond its border.
#include <algorithm>
#include <optional>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "structures/structure_cutter.hpp"

namespace realmodel::structures {

using cutting::Position;
using spatial::bounding_box;
using spatial::Box;

namespace {

constexpr double kTouches = 1e-9;  // of the extent of all: so near counts as met
constexpr std::uint8_t kMeets = 1, kPasses = 2;

/// What lies over and under a triangle in plan, between two heights at each corner.
struct Prism {
    std::array<Position, 6> corners;  ///< those below, then those above
    Box box;
};

/// A triangle that may meet prisms, and the planes through its edges at right angles to it.
struct Slab {
    std::array<Position, 3> corners;
    std::array<Position, 4> normals;  ///< its own, then outward across its edges
    Box box;
};

std::optional<Slab> slab_of(const std::array<Position, 3>& corners) {
    Slab slab{.corners = corners, .normals = {}, .box = bounding_box(corners)};
    const Position normal = triangle_normal(corners[0], corners[1], corners[2]);
    if (!(dot(normal, normal) > 0)) return std::nullopt;
    slab.normals[0] = unit(normal);
    for (std::size_t i = 0; i < 3; ++i)
        slab.normals[i + 1] = unit(cross(minus(corners[(i + 1) % 3], corners[i]), slab.normals[0]));
    return slab;
}

/// Whether all of some points are farther than `near` beyond a plane.
bool all_beyond(const auto& points, const Position& on, const Position& outward, double near) {
    return std::ranges::all_of(
        points, [&](const Position& p) { return dot(minus(p, on), outward) > near; });
}

/// False where a plane parts them, by so much at least.
bool may_meet(const Prism& prism, const Slab& slab, double near) {
    const Position& first = slab.corners[0];
    const Position& normal = slab.normals[0];
    if (all_beyond(prism.corners, first, normal, near) ||
        all_beyond(prism.corners, first, {-normal[0], -normal[1], -normal[2]}, near))
        return false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (all_beyond(prism.corners, slab.corners[i], slab.normals[i + 1], near)) return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const Position& a = prism.corners[i];
        const Position& b = prism.corners[(i + 1) % 3];
        Position outward{b[1] - a[1], a[0] - b[0], 0};
        if (dot(outward, minus(prism.corners[(i + 2) % 3], a)) > 0)
            outward = {-outward[0], -outward[1], 0};
        const double size = length(outward);
        if (size > 0 && all_beyond(slab.corners, a, outward, near * size)) return false;
    }
    return true;
}

}  // namespace

std::vector<std::uint8_t> triangles_beyond(std::span<const Structure> faults,
                                           std::span<const double> low,
                                           std::span<const double> high,
                                           std::span<const std::int32_t> triangles,
                                           const Execution& execution) {
    const std::size_t count = triangles.size() / 3;
    std::vector<Prism> prisms(count);
    Box all;
    for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t v = 3 * index(triangles[3 * t + i]);
            prisms[t].corners[i] = {low[v], low[v + 1], low[v + 2]};
            prisms[t].corners[i + 3] = {high[v], high[v + 1], high[v + 2]};
        }
        prisms[t].box = bounding_box(prisms[t].corners);
        all.include(prisms[t].box);
    }
    std::vector<std::uint8_t> touched(count, 0);
    if (count == 0) return touched;
    const StructureCutter cutter = cutter_of_first(faults, all);
    all.include(bounding_box(cutter.single[0].vertices));
    const Position extent = minus(all.high, all.low);
    const double near = kTouches * length(extent);
    Box sheet;
    for (Prism& prism : prisms) {
        prism.box.widen(near);
        sheet.include(prism.box);
    }
    std::vector<Slab> slabs;
    for (std::size_t t = 0; t < cutter.combined.triangles.size(); ++t) {
        if (cutter.is_continuation[t] == 0) continue;
        const auto slab = slab_of(cutter.combined.corners(t));
        if (slab && slab->box.meets(sheet)) slabs.push_back(*slab);
    }
    const spatial::BoxTree tree(transformed(slabs, &Slab::box), execution);
    parallel_ranges(count, 1 << 6, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Prism& prism = prisms[t];
            const auto passes = [&](std::int32_t number) {
                const Slab& slab = slabs[index(number)];
                if (!may_meet(prism, slab, near)) return false;
                touched[t] = kMeets;
                return may_meet(prism, slab, -near);
            };
            if (tree.any(prism.box, passes)) touched[t] = kPasses;
        }
    });
    return touched;
}

std::vector<std::array<std::array<double, 3>, 3>> continuation_of(
    std::span<const Structure> faults, const std::array<std::array<double, 3>, 2>& corners) {
    const StructureCutter cutter = cutter_of_first(faults, bounding_box(corners));
    std::vector<std::array<Position, 3>> triangles;
    for (std::size_t t = 0; t < cutter.combined.triangles.size(); ++t) {
        if (cutter.is_continuation[t] != 0) triangles.push_back(cutter.combined.corners(t));
    }
    return triangles;
}

}  // namespace realmodel::structures
