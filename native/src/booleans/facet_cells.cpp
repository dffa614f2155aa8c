// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_cells.hpp"

#include <algorithm>
#include <cassert>

#include "arrangement/ray_boxes.hpp"
#include "arrangement/space_cells.hpp"
#include "base/parallel.hpp"
#include "exact/rational_point.hpp"
#include "exact/space_predicates.hpp"

namespace realmodel::booleans {

using arrangement::EdgeUse;
using exact::SpacePointId;
using exact::SpacePoints;
using spatial::Box;

namespace {

class CellFinder {
public:
    CellFinder(const std::vector<Position>& vertices, const FacetMesh& mesh,
               const Execution& execution)
        : vertices_(vertices),
          mesh_(mesh),
          execution_(execution),
          connected_(mesh.facets.size()),
          cells_(2 * mesh.facets.size() + 1) {}

    FacetCells run() {
        join_around_edges();
        join_along_rays();
        return number_cells();
    }

private:
    /// The outside is a side of its own, and the first: so its cell is.
    static constexpr std::int32_t kOutsideSide = 0;
    static std::int32_t side_of(std::size_t facet, std::size_t side) {
        return static_cast<std::int32_t>(1 + 2 * facet + side);
    }

    void join_around_edges();
    arrangement::EdgeFan fan_of(std::size_t edge) const;
    void join_along_rays();
    bool cast(std::int32_t facet, int attempt, arrangement::RayBoxes& boxes);
    FacetCells number_cells();
    std::array<SpacePointId, 3> corners(SpacePoints& points, std::int32_t facet) const {
        std::array<SpacePointId, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = points.add(vertices_[index(mesh_.facets[index(facet)].corners[k])]);
        return result;
    }

    const std::vector<Position>& vertices_;
    const FacetMesh& mesh_;
    Execution execution_;
    DisjointSets connected_;  ///< facets, along edges
    arrangement::SpaceCells cells_;
};

/// What is between two facets that follow one another around an edge is one place.
void CellFinder::join_around_edges() {
    parallel_each(mesh_.edges.size(), execution_, [&](std::size_t e) {
        const auto uses = mesh_.edges[e];
        for (const EdgeUse& use : uses)
            connected_.join(uses[0].item, use.item);
        if (uses.size() < 3) {  // there is but one order
            for (std::size_t i = 0; i < uses.size(); ++i) {
                const EdgeUse &use = uses[i], &next = uses[(i + 1) % uses.size()];
                cells_.join(side_of(index(use.item), use.ahead()),
                            side_of(index(next.item), next.behind()));
            }
            return;
        }
        const arrangement::EdgeFan fan = fan_of(e);
        for (std::size_t blade = 0; blade < fan.blades(); ++blade)
            cells_.join_sector(uses, fan, blade, side_of);
    });
}

/// The facets around an edge.
arrangement::EdgeFan CellFinder::fan_of(std::size_t edge) const {
    const auto uses = mesh_.edges[edge];
    const auto& [a, b] = mesh_.edges.ends(edge);
    SpacePoints points;
    const auto point = [&](std::int32_t v) { return points.add(vertices_[index(v)]); };
    std::vector<arrangement::HalfPlane> items;
    for (const EdgeUse& use : uses) {
        const auto& c = mesh_.facets[index(use.item)].corners;
        // the corner that is no end of the edge
        items.push_back({point(c[0] ^ c[1] ^ c[2] ^ a ^ b), -1, use.direction});
    }
    arrangement::EdgeFan fan;
    find_fan(points, point(a), point(b), items, fan);
    assert(fan.blades() == uses.size());  // facets that coincide are one
    return fan;
}

/// Of the facets that a ray crosses, each sees the next one: so parts of the surfaces that do not
/// touch one another are known to lie in one place. One ray for each such part.
void CellFinder::join_along_rays() {
    const std::size_t count = mesh_.facets.size();
    Array<Box> boxes(count);
    parallel_each(count, execution_, [&](std::size_t f) {
        boxes[f] = spatial::bounding_box(
            mesh_.facets[f].corners,
            [&](std::int32_t v) -> const Position& { return vertices_[index(v)]; });
    });
    arrangement::RayBoxes ray_boxes(std::move(boxes));
    // facets of each part, of which one after another is tried
    std::vector<std::vector<std::int32_t>> parts;
    std::vector<std::int32_t> root(count), part_of(count, -1);
    parallel_each(count, execution_,
                  [&](std::size_t f) { root[f] = connected_.find(static_cast<std::int32_t>(f)); });
    constexpr std::size_t kTried = 64;
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        std::int32_t& part = part_of[index(root[f])];
        if (part < 0) {
            part = static_cast<std::int32_t>(parts.size());
            parts.emplace_back();
        }
        auto& own = parts[index(part)];
        if (own.size() < kTried) own.push_back(static_cast<std::int32_t>(f));
    }
    for (const auto& facets : parts) {
        for (std::size_t attempt = 0;; ++attempt) {
            if (execution_.progress != nullptr) execution_.progress->check();
            // of the places that are tried in a facet two at most are in line with an edge
            assert(attempt / facets.size() <= 2 * mesh_.edges.size());
            if (cast(facets[attempt % facets.size()], static_cast<int>(attempt / facets.size()),
                     ray_boxes))
                break;
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
bool CellFinder::cast(std::int32_t facet, int attempt, arrangement::RayBoxes& boxes) {
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
    for (const std::int32_t other :
         boxes.find(arrangement::ray_box(points, p, axis), execution_.progress)) {
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
    assert(!crossings.empty() && crossings[0].facet == facet);
    const auto side = [](const Crossing& c, bool is_beyond) {
        return side_of(index(c.facet), (c.side > 0) == is_beyond ? 1 : 0);
    };
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i)
        cells_.join(side(crossings[i], true), side(crossings[i + 1], false));
    cells_.join(side(crossings.back(), true), kOutsideSide);
    return true;
}

/// The outside, then the cells in the order of the facets around them. Their windings follow from
/// the outside's, as each facet changes them by what it is of either surface.
FacetCells CellFinder::number_cells() {
    using Winding = std::array<std::int32_t, 2>;
    const std::size_t count = mesh_.facets.size();
    cells_.number([](std::size_t) { return true; }, execution_);
    assert(cells_.of(kOutsideSide) == FacetCells::kOutside);
    FacetCells found;
    found.of_facet.resize(count);
    parallel_each(count, execution_, [&](std::size_t f) {
        for (std::size_t side = 0; side < 2; ++side)
            found.of_facet[f][side] = cells_.of(index(side_of(f, side)));
    });
    cells_.connect([&](const auto& visit) {
        std::array<std::int32_t, 2> last{-1, -1};  // most are between the cells of the one before
        for (std::size_t f = 0; f < count; ++f) {
            poll(execution_.progress, f);
            const auto& [below, above] = found.of_facet[f];
            if (below != above && found.of_facet[f] != last) visit(f, below, above);
            last = found.of_facet[f];
        }
    });
    std::vector<std::optional<Winding>> windings(cells_.size());
    windings[FacetCells::kOutside] = Winding{0, 0};
    std::size_t round = 0;
    const auto beyond = [&](const arrangement::SpaceCells::Way& way, const Winding& winding) {
        poll(execution_.progress, round++);
        Winding next = winding;
        for (std::size_t source = 0; source < 2; ++source)
            next[source] -= way.direction * mesh_.facets[index(way.facet)].times[source];
        return std::optional(next);
    };
    cells_.spread(FacetCells::kOutside, windings, beyond, [](const auto&) {});
    for (const auto& winding : windings)
        found.winding.push_back(winding.value_or(Winding{0, 0}));
    return found;
}

}  // namespace

FacetCells cells_of(const std::vector<Position>& vertices, const FacetMesh& mesh,
                    const Execution& execution) {
    return CellFinder(vertices, mesh, execution).run();
}

}  // namespace realmodel::booleans
