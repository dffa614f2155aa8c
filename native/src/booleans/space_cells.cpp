// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/space_cells.hpp"

#include <algorithm>
#include <optional>

#include "arrangement/edge_fan.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "exact/rational_point.hpp"
#include "exact/space_predicates.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::booleans {

using exact::SpacePointId;
using exact::SpacePoints;
using spatial::Box;

namespace {

constexpr std::size_t kFewRays = 16;

/// A side of a facet: 0 below it, 1 above. Sides that see each other are joined.
std::int32_t side_number(std::int32_t facet, std::size_t side) {
    return 2 * facet + static_cast<std::int32_t>(side);
}

class CellFinder {
public:
    CellFinder(const std::vector<Position>& vertices, const FacetMesh& mesh,
               const Execution& execution)
        : vertices_(vertices),
          mesh_(mesh),
          execution_(execution),
          sides_(2 * mesh.facets.size() + 1),
          outside_(static_cast<std::int32_t>(2 * mesh.facets.size())) {}

    SpaceCells run() {
        join_around_edges();
        join_along_rays();
        return number_cells();
    }

private:
    void join_around_edges();
    void join_along_rays();
    template <class Find>
    bool cast(std::int32_t facet, int attempt, const Find& find, const Box& whole);
    SpaceCells number_cells();
    std::array<SpacePointId, 3> corners(SpacePoints& points, std::int32_t facet) const {
        std::array<SpacePointId, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = points.add(vertices_[index(mesh_.facets[index(facet)].corners[k])]);
        return result;
    }

    const std::vector<Position>& vertices_;
    const FacetMesh& mesh_;
    Execution execution_;
    DisjointSets sides_;  ///< of facets, and the outside
    std::int32_t outside_;
};

/// What is between two facets that follow one another around an edge is one place.
void CellFinder::join_around_edges() {
    parallel_ranges(
        mesh_.edges.size(), 1 << 10, execution_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) {
                const auto uses = mesh_.uses_of(e);
                const auto join = [&](const FacetUse& from, const FacetUse& to) {
                    sides_.join(side_number(from.facet, from.ahead()),
                                side_number(to.facet, 1 - to.ahead()));
                };
                if (uses.size() < 3) {
                    for (std::size_t i = 0; i < uses.size(); ++i)
                        join(uses[i], uses[(i + 1) % uses.size()]);
                    continue;
                }
                SpacePoints points;
                const auto point = [&](std::int32_t v) { return points.add(vertices_[index(v)]); };
                const auto& edge = mesh_.edges[e];
                std::vector<arrangement::HalfPlane> items;
                for (const FacetUse& use : uses) {
                    const auto& c = mesh_.facets[index(use.facet)].corners;
                    // the corner that is no end of the edge
                    const std::int32_t tip = c[0] ^ c[1] ^ c[2] ^ edge[0] ^ edge[1];
                    items.push_back({point(tip), -1, use.direction});
                }
                const auto fan = fan_around(points, point(edge[0]), point(edge[1]), items);
                for (std::size_t i = 0; i < fan.order.size(); ++i)
                    join(uses[fan.order[i]], uses[fan.order[(i + 1) % fan.order.size()]]);
            }
        });
}

/// Of the facets that a ray crosses, each sees the next one: so parts of the surfaces that do not
/// touch one another are known to lie in one place. One ray for each such part.
void CellFinder::join_along_rays() {
    const std::size_t count = mesh_.facets.size();
    DisjointSets connected(count);
    for (std::size_t e = 0; e < mesh_.edges.size(); ++e) {
        poll(execution_.progress, e);
        const auto uses = mesh_.uses_of(e);
        for (const FacetUse& use : uses)
            connected.join(uses[0].facet, use.facet);
    }
    std::vector<Box> boxes(count);
    Box whole;
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        for (const std::int32_t v : mesh_.facets[f].corners)
            boxes[f].include(vertices_[index(v)]);
        whole.include(boxes[f]);
    }
    // facets of each part, of which one after another is tried
    std::vector<std::vector<std::int32_t>> parts;
    std::vector<std::int32_t> part_of(count, -1);
    constexpr std::size_t kTried = 64;
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        const auto root = index(connected.find(static_cast<std::int32_t>(f)));
        if (part_of[root] < 0) {
            part_of[root] = static_cast<std::int32_t>(parts.size());
            parts.emplace_back();
        }
        auto& own = parts[index(part_of[root])];
        if (own.size() < kTried) own.push_back(static_cast<std::int32_t>(f));
    }
    // for a few rays a tree is not worth its while
    std::optional<spatial::BoxTree> tree;
    if (parts.size() > kFewRays) tree.emplace(boxes, execution_.progress);
    const auto find = [&](const Box& ray, std::vector<std::int32_t>& near) {
        if (tree) return tree->find(ray, [&](std::int32_t other) { near.push_back(other); });
        for (std::size_t f = 0; f < count; ++f) {
            if (boxes[f].meets(ray)) near.push_back(static_cast<std::int32_t>(f));
        }
    };
    for (const auto& facets : parts) {
        // ends: of the places that are tried in a facet two at most are in line with an edge
        bool found = false;
        for (std::size_t attempt = 0; !found; ++attempt) {
            if (execution_.progress != nullptr) execution_.progress->check();
            found = cast(facets[attempt % facets.size()], static_cast<int>(attempt / facets.size()),
                         find, whole);
        }
    }
}

/// Places within a triangle: the middle, then others on a conic through it, which a line crosses
/// twice at most.
exact::RationalPoint place_within(const SpacePoints& points,
                                  const std::array<SpacePointId, 3>& corners, int attempt) {
    const std::array<mpz_class, 3> weights{1, attempt + 1, mpz_class(attempt + 1) * (attempt + 1)};
    exact::RationalPoint place;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i)
            place[k] += weights[i] * mpq_class(points.rounded(corners[i])[k]);
        place[k] /= weights[0] + weights[1] + weights[2];
    }
    return place;
}

/// From a point within a facet along an axis to the outside. False where it passes two facets in
/// one point: another point is to be tried.
template <class Find>
bool CellFinder::cast(std::int32_t facet, int attempt, const Find& find, const Box& whole) {
    SpacePoints points;
    const auto start = corners(points, facet);
    std::size_t axis = 0;
    while (exact::orient2d(points, axis, start[0], start[1], start[2]) == 0)
        ++axis;
    const SpacePointId p = points.add(place_within(points, start, attempt));
    struct Crossing {
        SpacePointId at;
        std::int32_t facet;
        int side;  ///< 1: the ray comes out above the facet, -1 below
    };
    std::vector<Crossing> crossings;
    Box ray;
    ray.include(points.rounded(p));
    ray.high[axis] = whole.high[axis];
    for (std::size_t k = 0; k < 3; ++k) {  // the point is not where its doubles are
        const double off = 1e-12 * std::max(std::abs(whole.low[k]), std::abs(whole.high[k]));
        ray.low[k] -= off;
        ray.high[k] += off;
    }
    std::vector<std::int32_t> near;
    find(ray, near);
    std::sort(near.begin(), near.end());
    for (const std::int32_t other : near) {
        const auto tips = corners(points, other);
        if (other == facet) {
            const int side = exact::orient2d(points, axis, tips[0], tips[1], tips[2]);
            crossings.push_back({p, other, side});
            continue;
        }
        const int side = exact::ray_crosses(points, axis, p, tips, false);
        if (side != 0)
            crossings.push_back(
                {points.projected(axis, p, tips[0], tips[1], tips[2]), other, side});
    }
    std::sort(crossings.begin(), crossings.end(), [&](const Crossing& a, const Crossing& b) {
        const int order = exact::compare(points, axis, a.at, b.at);
        return order != 0 ? order < 0 : a.facet < b.facet;
    });
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        if (exact::compare(points, axis, crossings[i].at, crossings[i + 1].at) == 0) return false;
    }
    const auto beyond = [](const Crossing& c) { return side_number(c.facet, c.side > 0 ? 1 : 0); };
    const auto before = [](const Crossing& c) { return side_number(c.facet, c.side > 0 ? 0 : 1); };
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i)
        sides_.join(beyond(crossings[i]), before(crossings[i + 1]));
    sides_.join(beyond(crossings.back()), outside_);
    return true;
}

/// The outside, then the cells in the order of the facets around them. Their windings follow from
/// the outside's, as each facet changes them by what it is of either surface.
SpaceCells CellFinder::number_cells() {
    SpaceCells cells;
    const std::size_t count = mesh_.facets.size();
    std::vector<std::int32_t> number(2 * count + 1, -1);
    number[index(sides_.find(outside_))] = SpaceCells::kOutside;
    std::int32_t next = 1;
    cells.of_facet.resize(count);
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        for (std::size_t side = 0; side < 2; ++side) {
            std::int32_t& cell =
                number[index(sides_.find(side_number(static_cast<std::int32_t>(f), side)))];
            if (cell < 0) cell = next++;
            cells.of_facet[f][side] = cell;
        }
    }
    std::vector<std::vector<std::int32_t>> facets_around(index(next));
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        const auto& [below, above] = cells.of_facet[f];
        if (below == above) continue;
        facets_around[index(below)].push_back(static_cast<std::int32_t>(f));
        facets_around[index(above)].push_back(static_cast<std::int32_t>(f));
    }
    cells.winding.assign(index(next), {0, 0});
    std::vector<std::uint8_t> is_known(index(next), 0);
    std::vector<std::int32_t> open{SpaceCells::kOutside};
    is_known[SpaceCells::kOutside] = 1;
    for (std::size_t n = 0; !open.empty(); ++n) {
        poll(execution_.progress, n);
        const std::int32_t cell = open.back();
        open.pop_back();
        for (const std::int32_t f : facets_around[index(cell)]) {
            const auto& [below, above] = cells.of_facet[index(f)];
            const std::int32_t other = below == cell ? above : below;
            if (is_known[index(other)] != 0) continue;
            is_known[index(other)] = 1;
            open.push_back(other);
            for (std::size_t source = 0; source < 2; ++source) {
                // a surface goes once round what lies below it
                const std::int32_t times = mesh_.facets[index(f)].times[source];
                cells.winding[index(other)][source] =
                    cells.winding[index(cell)][source] + (other == below ? times : -times);
            }
        }
    }
    return cells;
}

}  // namespace

SpaceCells cells_of(const std::vector<Position>& vertices, const FacetMesh& mesh,
                    const Execution& execution) {
    return CellFinder(vertices, mesh, execution).run();
}

}  // namespace realmodel::booleans
