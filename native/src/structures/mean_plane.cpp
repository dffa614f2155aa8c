// SPDX-License-Identifier: GPL-3.0-or-later
// Where a fault that dies out goes on beyond its border.
#include "structures/mean_plane.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::structures {

using cutting::NodeId;
using cutting::Position;
using meshing::PlanPoint;

namespace {

/// The directions of a plane and a point of it.
struct PlaneFrame {
    Position origin, strike, dip;

    Position at(const PlanPoint& p) const {
        Position place{};
        for (std::size_t k = 0; k < 3; ++k)
            place[k] = origin[k] + p[0] * strike[k] + p[1] * dip[k];
        return place;
    }
    PlanPoint seen(const Position& p) const {
        const Position off = minus(p, origin);
        return {dot(off, strike), dot(off, dip)};
    }
};

/// The plane through the middle of a surface, by areas, at right angles to its mean normal.
std::optional<PlaneFrame> mean_plane(const cutting::CutterSurface& surface) {
    const auto at = [&](NodeId v) { return surface.vertices[index(v)]; };
    const Position first = at(surface.triangles[0][0]);  // exact where the plane is that of an axis
    Position normal{0, 0, 0}, total{0, 0, 0};
    double whole = 0;
    for (const auto& t : surface.triangles) {
        const Position own = triangle_normal(at(t[0]), at(t[1]), at(t[2]));
        const double area = length(own);
        whole += area;
        for (std::size_t k = 0; k < 3; ++k) {
            normal[k] += own[k];
            for (const NodeId v : t)
                total[k] += area * (at(v)[k] - first[k]);
        }
    }
    normal = unit(normal);
    if (normal == Position{}) return std::nullopt;
    Position strike{-normal[1], normal[0], 0};
    if (elementary::hypot(normal[0], normal[1]) < 1e-6) strike = cross({0, 1, 0}, normal);
    strike = unit(strike);
    Position middle = first;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] += total[k] / (3 * whole);
    return PlaneFrame{middle, strike, cross(normal, strike)};
}

/// The triangles, by places in plan, that lie outside what directed edges have on their left;
/// nothing where edges cross, or something is on the left of two or none too few.
std::optional<std::vector<std::array<std::int32_t, 3>>> outside(
    const std::vector<PlanPoint>& places, const std::vector<std::array<std::int32_t, 2>>& edges) {
    meshing::ConstrainedTriangulation mesh;
    try {
        mesh = meshing::constrained_delaunay(places, edges);
    } catch (const InputError&) {
        return std::nullopt;  // edges that cross, or places that are equal
    }
    std::map<std::array<std::int32_t, 2>, std::int32_t> rises;  // across edges, to their left
    for (const auto& [from, to] : edges) {
        ++rises[{from, to}];
        --rises[{to, from}];
    }
    std::vector<std::int32_t> depth(mesh.triangles.size(), -1), open;
    std::size_t passed = 0;
    const auto reach = [&](std::size_t t, std::int32_t value) {
        if (depth[t] == value) return true;
        if (depth[t] >= 0 || value < 0 || value > 1) return false;
        depth[t] = value;
        open.push_back(static_cast<std::int32_t>(t));
        return true;
    };
    for (std::size_t t = 0; t < depth.size(); ++t) {
        if (std::ranges::find(mesh.neighbors[t], -1) != mesh.neighbors[t].end() && !reach(t, 0))
            return std::nullopt;
    }
    while (!open.empty()) {
        const std::size_t t = index(open.back());
        open.pop_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t next = mesh.neighbors[t][i];
            const auto across = rises.find({mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]});
            if (across != rises.end()) ++passed;
            if (next < 0) continue;
            const std::int32_t rise = across == rises.end() ? 0 : across->second;
            if (!reach(index(next), depth[t] - rise)) return std::nullopt;
        }
    }
    // an edge through another place is in two parts, and gapes there
    if (passed != rises.size()) return std::nullopt;
    assert(std::ranges::find(depth, -1) == depth.end());
    std::vector<std::array<std::int32_t, 3>> found;
    for (std::size_t t = 0; t < depth.size(); ++t) {
        if (depth[t] == 0) found.push_back(mesh.triangles[t]);
    }
    return found;
}

}  // namespace

std::optional<std::vector<std::array<Position, 3>>> continued_in_mean_plane(
    const cutting::CutterSurface& fault, std::span<const std::array<NodeId, 2>> border,
    std::span<const double> lengths) {
    const auto plane = mean_plane(fault);
    if (!plane) return std::nullopt;
    std::map<NodeId, std::int32_t> number;
    std::vector<PlanPoint> places;
    std::vector<Position> corners;
    std::vector<std::array<std::int32_t, 2>> edges;
    std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    const auto add = [&](const PlanPoint& seen, const Position& place) {
        places.push_back(seen);
        corners.push_back(place);
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], seen[k]);
            high[k] = std::max(high[k], seen[k]);
        }
    };
    for (const auto& edge : border) {
        auto& own = edges.emplace_back();
        for (std::size_t i = 0; i < 2; ++i) {
            const auto [known, is_new] =
                number.try_emplace(edge[i], static_cast<std::int32_t>(places.size()));
            const Position& place = fault.vertices[index(edge[i])];
            if (is_new) add(plane->seen(place), place);
            own[i] = known->second;
        }
    }
    if (edges.empty()) return std::nullopt;
    // wide enough for the surface to come down to the plane by and by
    const double margin = elementary::hypot(high[0] - low[0], high[1] - low[1]) / 2;
    std::array<PlanPoint, 4> inner{{{low[0] - margin, low[1] - margin},
                                    {high[0] + margin, low[1] - margin},
                                    {high[0] + margin, high[1] + margin},
                                    {low[0] - margin, high[1] + margin}}};
    const std::array<PlanPoint, 4> first = inner;
    for (const PlanPoint& corner : first)
        add(corner, plane->at(corner));
    const auto filled = outside(places, edges);
    if (!filled) return std::nullopt;
    std::vector<std::array<Position, 3>> triangles;
    for (const auto& t : *filled)
        triangles.push_back({corners[index(t[0])], corners[index(t[1])], corners[index(t[2])]});
    for (const double length : lengths) {
        std::array<PlanPoint, 4> outer = first;
        for (std::size_t i = 0; i < 4; ++i) {
            outer[i][0] += i == 1 || i == 2 ? length : -length;
            outer[i][1] += i >= 2 ? length : -length;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t j = (i + 1) % 4;
            const Position a = plane->at(outer[i]), b = plane->at(outer[j]),
                           c = plane->at(inner[j]), d = plane->at(inner[i]);
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
        inner = outer;
    }
    return triangles;
}

}  // namespace realmodel::structures
