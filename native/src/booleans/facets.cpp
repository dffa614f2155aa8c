// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facets.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "arrangement/space_cells.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "exact/space_points.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::booleans {

using arrangement::EdgeUse;
using exact::SpacePointId;
using exact::SpacePoints;
using spatial::Box;

namespace {

/// Whether one triangle's corners are an even permutation of another's.
bool turn_alike(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a[0] == b[k]) return a[1] == b[(k + 1) % 3];
    }
    return false;
}

struct KeyedPiece {
    std::array<std::int32_t, 3> sorted;
    std::int32_t piece;
    auto operator<=>(const KeyedPiece&) const = default;
};

void find_facets(const RefinedTriangles& refined, FacetMesh& mesh, const Execution& execution) {
    const std::size_t count = refined.triangles.size();
    constexpr std::size_t kChunk = 1 << 12;
    const auto keyed =
        sorted_in_buckets<KeyedPiece>(
            refined.vertices.size(), (count + kChunk - 1) / kChunk,
            [&](std::size_t chunk, const auto& put) {
                for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk);
                     ++i) {
                    KeyedPiece key{refined.triangles[i].corners, static_cast<std::int32_t>(i)};
                    std::sort(key.sorted.begin(), key.sorted.end());
                    put(index(key.sorted[0]), key);
                }
            },
            execution)
            .values;
    // pieces that coincide lie one after another, the first of them first
    const auto for_each_group = [&](const auto& visit) {
        parallel_for_each(count, execution, [&](std::size_t i) {
            if (i > 0 && keyed[i].sorted == keyed[i - 1].sorted) return;
            std::size_t end = i + 1;
            while (end < count && keyed[end].sorted == keyed[i].sorted)
                ++end;
            visit(std::span(keyed.begin() + i, keyed.begin() + end));
        });
    };
    mesh.first_piece.resize(count);
    for_each_group([&](std::span<const KeyedPiece> equal_pieces) {
        for (const KeyedPiece& key : equal_pieces)
            mesh.first_piece[index(key.piece)] = equal_pieces[0].piece;
    });
    mesh.of_piece.resize(count);
    number_in_order(
        count, execution,
        [&](std::size_t i) { return mesh.first_piece[i] == static_cast<std::int32_t>(i); },
        [&](std::size_t facets) { mesh.facets.resize(facets); },
        [&](std::size_t i, std::size_t facet) {
            mesh.facets[facet].corners = refined.triangles[i].corners;
            mesh.of_piece[i] = static_cast<std::int32_t>(facet);
        });
    for_each_group([&](std::span<const KeyedPiece> equal_pieces) {
        const std::int32_t number = mesh.of_piece[index(equal_pieces[0].piece)];
        Facet& facet = mesh.facets[index(number)];
        for (const KeyedPiece& key : equal_pieces) {
            const RefinedTriangle& piece = refined.triangles[index(key.piece)];
            mesh.of_piece[index(key.piece)] = number;
            facet.times[piece.source] += turn_alike(piece.corners, facet.corners) ? 1 : -1;
            facet.is_of[piece.source] = true;
        }
    });
}

}  // namespace

FacetMesh facets_of(const RefinedTriangles& refined, const Execution& execution) {
    FacetMesh mesh;
    find_facets(refined, mesh, execution);
    const std::size_t count = mesh.facets.size();
    checked_number(2 * count + 1, "sides of triangles");  // those who ask number them
    mesh.edges = arrangement::edges_of(
        count, refined.vertices.size(),
        [&](std::size_t f) -> const auto& { return mesh.facets[f].corners; }, execution);
    assert(mesh.edges.uses.size() == 3 * count);
    return mesh;
}

namespace {

bool is_intersection(const FacetMesh& mesh, std::size_t edge) {
    bool of_first = false, of_second = false, of_one = false;
    for (const EdgeUse& use : mesh.edges[edge]) {
        const auto& is_of = mesh.facets[index(use.item)].is_of;
        of_first = of_first || is_of[0];
        of_second = of_second || is_of[1];
        of_one = of_one || is_of[0] != is_of[1];
    }
    return of_first && of_second && of_one;
}

/// The intersection edges as a graph.
class LoopGraph {
public:
    LoopGraph(const FacetMesh& mesh, std::size_t vertices, const Execution& execution)
        : mesh_(mesh) {
        result_.of_edge.assign(mesh.edges.size(), -1);
        std::vector<std::uint8_t> is_in_loop(mesh.edges.size());
        parallel_for_each(mesh.edges.size(), execution,
                          [&](std::size_t e) { is_in_loop[e] = is_intersection(mesh, e); });
        edges_at_ = bucketize<std::int32_t>(vertices, [&](const auto& put) {
            for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
                poll(execution.progress, e);
                if (is_in_loop[e] == 0) continue;
                for (const std::int32_t v : mesh.edges.ends(e))
                    put(index(v), static_cast<std::int32_t>(e));
            }
        });
    }

    /// First the paths between vertices that have not two edges, then the cycles of those that do.
    IntersectionLoops run(Progress* progress) {
        for (const bool paths : {true, false}) {
            for (std::size_t v = 0; v < edges_at_.size(); ++v) {
                poll(progress, v);
                for (const std::int32_t edge : edges_at_[v]) {
                    const auto vertex = static_cast<std::int32_t>(v);
                    if (result_.of_edge[index(edge)] < 0 && (degree(vertex) != 2) == paths)
                        follow(vertex, edge);
                }
            }
        }
        return std::move(result_);
    }

private:
    std::size_t degree(std::int32_t vertex) const { return edges_at_[index(vertex)].size(); }
    void follow(std::int32_t start, std::int32_t edge) {
        const auto number = static_cast<std::int32_t>(result_.loops.size());
        IntersectionLoop loop{LoopKind::kOpen, {start}};
        for (std::int32_t at = start;;) {
            assert(result_.of_edge[index(edge)] < 0);  // each edge is in one loop
            result_.of_edge[index(edge)] = number;
            const auto& ends = mesh_.edges.ends(index(edge));
            at = ends[0] == at ? ends[1] : ends[0];
            if (at == start && degree(at) == 2) {
                loop.kind = LoopKind::kHardClosed;
                break;
            }
            loop.vertices.push_back(at);
            if (degree(at) != 2) {
                if (degree(start) > 2 && degree(at) > 2) loop.kind = LoopKind::kSoftClosed;
                break;
            }
            const auto both = edges_at_[index(at)];
            edge = both[0] == edge ? both[1] : both[0];
        }
        result_.loops.push_back(std::move(loop));
    }

    const FacetMesh& mesh_;
    IntersectionLoops result_;
    Buckets<std::int32_t> edges_at_;  ///< of vertices: intersection edges
};

}  // namespace

IntersectionLoops find_loops(const FacetMesh& mesh, std::size_t vertices,
                             const Execution& execution) {
    return LoopGraph(mesh, vertices, execution).run(execution.progress);
}

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
    parallel_for_each(mesh_.edges.size(), execution_, [&](std::size_t e) {
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
        for (std::size_t half_plane = 0; half_plane < fan.half_planes(); ++half_plane)
            cells_.join_sector(uses, fan, half_plane, side_of);
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
        // the corner across from the edge
        items.push_back({point(c[0] ^ c[1] ^ c[2] ^ a ^ b), -1, use.direction});
    }
    arrangement::EdgeFan fan;
    find_fan(points, point(a), point(b), items, fan);
    assert(fan.half_planes() == uses.size());  // facets that coincide are one
    return fan;
}

/// Of the facets that a ray crosses, each sees the next one: so components of the surfaces that do
/// not touch one another are known to lie in one place. One ray for each such component.
void CellFinder::join_along_rays() {
    const std::size_t count = mesh_.facets.size();
    Array<Box> boxes(count);
    parallel_for_each(count, execution_, [&](std::size_t f) {
        boxes[f] = spatial::bounding_box(
            mesh_.facets[f].corners,
            [&](std::int32_t v) -> const Position& { return vertices_[index(v)]; });
    });
    arrangement::RayBoxes ray_boxes(std::move(boxes));
    // facets of each component, of which one after another is tried
    std::vector<std::vector<std::int32_t>> components;
    std::vector<std::int32_t> root(count), component_of(count, -1);
    parallel_for_each(count, execution_, [&](std::size_t f) {
        root[f] = connected_.find(static_cast<std::int32_t>(f));
    });
    constexpr std::size_t kTried = 64;
    for (std::size_t f = 0; f < count; ++f) {
        poll(execution_.progress, f);
        std::int32_t& component = component_of[index(root[f])];
        if (component < 0) {
            component = static_cast<std::int32_t>(components.size());
            components.emplace_back();
        }
        auto& component_facets = components[index(component)];
        if (component_facets.size() < kTried)
            component_facets.push_back(static_cast<std::int32_t>(f));
    }
    // of the places that are tried in a facet two at most are in line with an edge
    const std::size_t most_places = 2 * mesh_.edges.size() + 1;
    for (const auto& facets : components) {
        std::size_t attempt = 0;
        while (!cast(facets[attempt % facets.size()], static_cast<int>(attempt / facets.size()),
                     ray_boxes)) {
            if (execution_.progress != nullptr) execution_.progress->check();
            if (++attempt == most_places * facets.size())
                throw InternalError("some ray from a facet crosses no two others in one point",
                                    vertices_[index(mesh_.facets[index(facets[0])].corners[0])]);
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
    struct RayCrossing {
        SpacePointId at;
        std::int32_t facet;
        int side;  ///< 1: the ray comes out above the facet, -1 below
    };
    std::vector<RayCrossing> crossings;
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
    std::sort(crossings.begin(), crossings.end(), [&](const RayCrossing& a, const RayCrossing& b) {
        const int order = exact::compare(points, axis, a.at, b.at);
        return order != 0 ? order < 0 : a.facet < b.facet;
    });
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        if (exact::compare(points, axis, crossings[i].at, crossings[i + 1].at) == 0) return false;
    }
    assert(!crossings.empty() && crossings[0].facet == facet);
    const auto side = [](const RayCrossing& c, bool is_beyond) {
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
    using WindingPair = std::array<std::int32_t, 2>;
    const std::size_t count = mesh_.facets.size();
    cells_.number([](std::size_t) { return true; }, execution_);
    assert(cells_.of(kOutsideSide) == FacetCells::kOutside);
    FacetCells cells;
    cells.of_facet.resize(count);
    parallel_for_each(count, execution_, [&](std::size_t f) {
        for (std::size_t side = 0; side < 2; ++side)
            cells.of_facet[f][side] = cells_.of(index(side_of(f, side)));
    });
    cells_.connect([&](const auto& visit) {
        std::array<std::int32_t, 2> last{-1, -1};  // most are between the cells of the one before
        for (std::size_t f = 0; f < count; ++f) {
            poll(execution_.progress, f);
            const auto& [below, above] = cells.of_facet[f];
            if (below != above && cells.of_facet[f] != last) visit(f, below, above);
            last = cells.of_facet[f];
        }
    });
    std::vector<std::optional<WindingPair>> windings(cells_.size());
    windings[FacetCells::kOutside] = WindingPair{0, 0};
    std::size_t round = 0;
    const auto beyond = [&](const arrangement::SpaceCells::Way& way, const WindingPair& winding) {
        poll(execution_.progress, round++);
        WindingPair next = winding;
        for (std::size_t source = 0; source < 2; ++source)
            next[source] -= way.direction * mesh_.facets[index(way.facet)].times[source];
        return std::optional(next);
    };
    cells_.spread(FacetCells::kOutside, windings, beyond, [](const auto&) {});
    for (const auto& winding : windings)
        cells.winding.push_back(winding.value_or(WindingPair{0, 0}));
    return cells;
}

}  // namespace

FacetCells cells_of(const std::vector<Position>& vertices, const FacetMesh& mesh,
                    const Execution& execution) {
    return CellFinder(vertices, mesh, execution).run();
}

}  // namespace realmodel::booleans
