// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/triangulate.hpp"
#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

namespace {

using Triangles = std::vector<std::array<std::int32_t, 3>>;

std::vector<PlanPoint> corners_of(std::span<const Ring> rings) {
    std::vector<PlanPoint> corners;
    for (const Ring& ring : rings)
        corners.insert(corners.end(), ring.begin(), ring.end());
    return corners;
}

/// By ear clipping and swaps of edges; none where that needs more than ears.
std::optional<Triangles> by_ears(std::span<const Ring> rings, Progress* progress) {
    std::vector<PlanPoint> corners = corners_of(rings);
    std::vector<arrangement::Loop> loops;
    std::vector<std::int32_t> numbers;  // of the loops' corners
    std::int32_t corner = 0;
    for (const Ring& ring : rings) {
        arrangement::Loop& loop = loops.emplace_back();
        loop.reserve(ring.size());
        const std::size_t begin = numbers.size();
        for (const PlanPoint& p : ring) {
            const std::int32_t number = corner++;
            if (!loop.empty() && loop.back().at == p) continue;
            loop.push_back({number, p});
            numbers.push_back(number);
        }
        while (loop.back().at == loop.front().at) {
            loop.pop_back();
            numbers.pop_back();
        }
        const double area = arrangement::twice_loop_area(loop);
        if (loops.size() == 1 ? area < 0 : area > 0) {
            std::ranges::reverse(loop);
            std::reverse(numbers.begin() + static_cast<std::ptrdiff_t>(begin), numbers.end());
        }
    }
    Triangles triangles;
    if (!arrangement::cut_ears(loops, {0, 0}, {}, arrangement::EarChoice::kRound, triangles,
                               progress))
        return std::nullopt;
    for (auto& triangle : triangles)
        for (std::int32_t& c : triangle)
            c = numbers[c];
    FlatMesh mesh({std::move(corners), std::move(triangles)});
    const Check check = stopped_by(progress);
    Ticker tick(check);
    std::vector<HalfEdge> open;
    // All are asked before the first is flipped: then no answer waits for another.
    mesh.for_each_edge([&](HalfEdge edge) {
        tick(0);
        if (mesh.twin(edge).triangle() > edge.triangle() && mesh.should_flip(edge))
            open.push_back(edge);
    });
    mesh.legalize(open);
    return std::move(mesh.corners);
}

/// The same by constrained Delaunay triangulation, corners named by their first appearance.
Triangles by_region(std::span<const Ring> rings, Progress* progress) {
    Triangles triangles = triangulate_rings(rings, progress).triangles;
    const std::vector<std::int32_t> first = first_equal(corners_of(rings));
    std::vector<std::int32_t> corner_of;  // of each vertex
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (std::cmp_equal(first[i], i)) corner_of.push_back(first[i]);
    }
    for (auto& triangle : triangles)
        for (std::int32_t& c : triangle)
            c = corner_of[c];
    return triangles;
}

/// Whether ear clipping can begin: three distinct corners in each ring, all of them finite.
bool is_plain(std::span<const Ring> rings) {
    if (rings.empty()) return false;
    return std::all_of(rings.begin(), rings.end(), [](const Ring& ring) {
        if (ring.size() < 3) return false;
        const bool is_finite = std::all_of(ring.begin(), ring.end(), [](const PlanPoint& p) {
            return std::isfinite(p[0]) && std::isfinite(p[1]);
        });
        const auto other = std::find_if(ring.begin(), ring.end(),
                                        [&](const PlanPoint& p) { return p != ring[0]; });
        return is_finite && other != ring.end() &&
               std::any_of(other, ring.end(),
                           [&](const PlanPoint& p) { return orient2d(ring[0], *other, p) != 0; });
    });
}

}  // namespace

Triangles triangulate_polygon(std::span<const Ring> rings, Progress* progress) {
    if (is_plain(rings)) {
        if (auto triangles = by_ears(rings, progress)) return std::move(*triangles);
    }
    return by_region(rings, progress);
}

}  // namespace realmodel::meshing
