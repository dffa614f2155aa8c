// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/snapping.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/floating_point.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "spatial/hash_grid.hpp"

namespace realmodel::booleans {

namespace {

constexpr std::size_t kTrianglesAtOnce = 1 << 6, kPairs = 1 << 10;

template <class Item>
void append(std::vector<Item>& to, const std::vector<Item>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

/// Pieces of one triangle that have been folded upon each other go, two and two.
void cancel_folds(std::vector<TrianglePiece>& pieces) {
    struct Folded {
        TriangleCorners corners;
        bool is_odd;
        std::size_t piece;
        auto operator<=>(const Folded&) const = default;
    };
    std::vector<Folded> sorted;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const auto [corners, is_odd] = in_order(pieces[i].corners);
        sorted.push_back({corners, is_odd, i});
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint8_t> goes(pieces.size(), 0);
    for (const auto folded : groups_of(sorted, &Folded::corners)) {
        const auto odd = std::ranges::find_if(folded, &Folded::is_odd);
        for (auto even = folded.begin(), back = odd; even != odd && back != folded.end();
             ++even, ++back)
            goes[even->piece] = goes[back->piece] = 1;
    }
    std::size_t remaining = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (goes[i] == 0) pieces[remaining++] = pieces[i];
    }
    pieces.resize(remaining);
}

}  // namespace

/// New vertices are also inserted into nearby pieces, breadth first from the pairs on, so that
/// layers that lie upon one another are divided alike.
Snapping::Snapping(TrianglePieces& pieces, std::span<const FacetPair> pairs, const Radius& radius,
                   const Execution& execution)
    : pieces_(pieces),
      wide_(pieces.points, radius.of_pairs),
      narrow_(pieces.points, radius.of_the_rest),
      execution_(execution) {
    std::vector<std::int32_t> facets;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        poll(execution.progress, i);
        for (const TriangleCorners& corners : pairs[i])
            facets.push_back(facets_.add(corners));
    }
    sort_unique(facets);
    first_ = facets_.size();
    NearFeatures features;
    Waves waves;
    for (std::int32_t wave = 0; !facets.empty(); ++wave) {
        waves.resize(facets_.size(), -1);
        for (const std::int32_t facet : facets)
            waves[index(facet)] = wave;
        const auto around = pairs_around(facets, waves);
        facets = find_near(around, waves, features);
    }
    merge_vertices(features.same);
    // where vertices become one the rest is found again, with those that remain
    if (merged_.empty()) place(std::move(features));
}

Snapping::Snapping(TrianglePieces& pieces, std::span<const TriangleCorners> flat,
                   const Execution& execution)
    : pieces_(pieces), wide_(pieces.points, 0), narrow_(pieces.points, 0), execution_(execution) {
    for (const TriangleCorners& t : flat) {
        for (std::size_t k = 0; k < 3; ++k) {
            const SpaceEdge edge = unordered(t[k], t[(k + 1) % 3]);
            if (!narrow_.is_between(t[(k + 2) % 3], edge)) continue;
            const std::int32_t number = edges_.add(edge);
            on_edges_.resize(edges_.size());
            on_edges_[index(number)].points.push_back(t[(k + 2) % 3]);
        }
    }
    order_points();
}

/// Some facets with all that come near them: each pair once, whichever of the two is asked first.
std::vector<Snapping::FacetNumbers> Snapping::pairs_around(std::span<const std::int32_t> facets,
                                                           Waves& waves) {
    constexpr std::size_t kAtOnce = 1 << 14;
    std::vector<FacetNumbers> pairs;
    std::vector<std::vector<TriangleCorners>> around(std::min(kAtOnce, facets.size()));
    for (std::size_t first = 0; first < facets.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, facets.size() - first);
        parallel_ranges(count, kTrianglesAtOnce, execution_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i) {
                                auto& neighbors = around[i];
                                neighbors.clear();
                                spatial::Box box = pieces_.box(facets_[facets[first + i]]);
                                box.widen(reach(facets[first + i]));
                                pieces_.find(box, [&neighbors](const TrianglePiece& piece) {
                                    neighbors.push_back(in_order(piece.corners).first);
                                });
                                sort_unique(neighbors);
                            }
                        });
        for (std::size_t i = 0; i < count; ++i) {
            if (execution_.progress != nullptr) execution_.progress->check();
            const std::int32_t facet = facets[first + i];
            for (const TriangleCorners& corners : around[i]) {
                const std::int32_t other = facets_.add(corners);
                waves.resize(facets_.size(), -1);
                const std::int32_t current = waves[index(facet)], wave = waves[index(other)];
                if (wave < 0 || (wave == current && facet < other)) pairs.push_back({facet, other});
            }
        }
    }
    return pairs;
}

/// Looks for what is near in pairs of facets.
/// @return facets of near pairs that were not asked before what is around them
std::vector<std::int32_t> Snapping::find_near(std::span<const FacetNumbers> pairs,
                                              const Waves& waves, NearFeatures& all) {
    struct NearPairs {
        NearFeatures features;
        std::vector<FacetNumbers> near;
        double moved = 0;
    };
    std::vector<NearPairs> chunks((pairs.size() + kPairs - 1) / kPairs);
    const auto work = [&](std::size_t begin, std::size_t end) {
        NearPairs& chunk = chunks[begin / kPairs];
        NearFeatures features;
        for (std::size_t i = begin; i < end; ++i) {
            const FacetPair pair = pair_of(facets_[pairs[i][0]], facets_[pairs[i][1]]);
            const Nearness& pair_nearness = nearness(pairs[i]);
            pair_nearness.find(pair, features);
            if (features.empty()) continue;
            chunk.near.push_back(pairs[i]);
            chunk.moved = std::max(chunk.moved, pair_nearness.distance_of(pair));
            chunk.features.take(features);
        }
        chunk.features.make_unique();
    };
    parallel_ranges(pairs.size(), kPairs, execution_, work);
    std::vector<std::int32_t> next;
    for (NearPairs& chunk : chunks) {
        if (execution_.progress != nullptr) execution_.progress->check();
        all.take(chunk.features);
        near_.insert(near_.end(), chunk.near.begin(), chunk.near.end());
        moved_ = std::max(moved_, chunk.moved);
        for (const FacetNumbers& pair : chunk.near) {
            for (const std::int32_t facet : pair) {
                if (waves[index(facet)] < 0) next.push_back(facet);
            }
        }
    }
    sort_unique(all.same);
    sort_unique(next);
    return next;
}

/// Of vertices that become one the first stands for all: the inputs' come before new ones.
void Snapping::merge_vertices(const std::vector<SpaceEdge>& same) {
    if (same.empty()) return;
    moved_ = 0;
    std::vector<SpacePointId> vertices;
    for (const SpaceEdge& pair : same)
        vertices.insert(vertices.end(), pair.begin(), pair.end());
    sort_unique(vertices);
    const auto number = [&](SpacePointId p) {
        return static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), p) -
                                         vertices.begin());
    };
    DisjointSets sets(vertices.size());
    for (std::size_t i = 0; i < same.size(); ++i) {
        poll(execution_.progress, i);
        sets.join(number(same[i][0]), number(same[i][1]));
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const auto to = index(sets.find(static_cast<std::int32_t>(i)));
        if (to == i) continue;
        assert(to < i && sets.find(static_cast<std::int32_t>(to)) == static_cast<std::int32_t>(to));
        merged_.push_back({vertices[i], vertices[to]});
        moved_ = std::max(moved_, distance(pieces_.points.rounded(vertices[i]),
                                           pieces_.points.rounded(vertices[to])));
    }
}

/// Gives what was found to the edges and facets.
void Snapping::place(NearFeatures&& features) {
    places_.resize(facets_.size());
    for (std::size_t i = 0; i < near_.size(); ++i) {
        poll(execution_.progress, i);
        const auto [one, other] = near_[i];
        for (const auto& [facet, near] : {std::pair(one, other), std::pair(other, one)}) {
            NearFacet& place = places_[index(facet)];
            if (place.near.empty()) {
                const auto edges = edges_of(facets_[facet]);
                for (std::size_t k = 0; k < 3; ++k)
                    place.edges[k] = edges_.add(edges[k]);
            }
            place.near.push_back(near);
        }
    }
    near_ = {};
    for (const auto& [corners, p] : features.over)
        places_[index(facets_.find(corners))].over.push_back(p);
    std::vector<OnEdge> on_edges;
    const auto give = [&](const SpaceEdge& edge, SpacePointId p) {
        on_edges.emplace_back(edges_.add(edge), p);
    };
    for (const auto& [edge, p] : features.on_edges)
        give(edge, p);
    sort_unique(features.crossings);
    if (!features.crossings.empty()) {
        std::vector<SpacePointId> vertices;
        for (const TriangleCorners& facet : facets_.keys())
            vertices.insert(vertices.end(), facet.begin(), facet.end());
        sort_unique(vertices);
        spatial::HashGrid<3> grid(2 * wide_.distance_at(pieces_.largest_coordinate()));
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            poll(execution_.progress, i);
            grid.add(pieces_.points.rounded(vertices[i]));
        }
        for (const NearFeatures::NearCrossing& crossing : features.crossings) {
            if (execution_.progress != nullptr) execution_.progress->check();
            // the nearest vertex, of equally near ones the first
            std::pair<double, SpacePointId> nearest{crossing.within, kNone};
            grid.any(crossing.at, crossing.within, [&](std::size_t i) {
                const std::pair candidate(distance(grid.points()[i], crossing.at), vertices[i]);
                if (candidate.first <= crossing.within &&
                    (!nearest.second.has_value() || candidate < nearest))
                    nearest = candidate;
                return false;
            });
            SpacePointId p = nearest.second;
            if (!p.has_value()) {
                p = pieces_.points.add(crossing.at);
                vertices.push_back(p);
                grid.add(crossing.at);
            }
            for (const SpaceEdge& edge : {crossing.one, crossing.other}) {
                if (p != edge[0] && p != edge[1] && narrow_.is_between(p, edge)) give(edge, p);
            }
        }
    }
    on_edges_.resize(edges_.size());
    add_points(std::move(on_edges));
    spread_points();
    order_points();
}

/// Adds points to edges, each once.
/// @return whether any is new
bool Snapping::add_points(std::vector<OnEdge>&& on_edges) {
    parallel_sort(on_edges, std::less<>(), execution_);
    for (DividedEdge& edge : on_edges_)
        edge.old = edge.points.size();
    on_edges.erase(std::unique(on_edges.begin(), on_edges.end()), on_edges.end());
    bool is_new = false;
    std::size_t round = 0;
    for (const auto group : groups_of(on_edges, &OnEdge::first)) {
        DividedEdge& edge = on_edges_[index(group[0].first)];
        std::vector<SpacePointId> known = edge.points;
        std::sort(known.begin(), known.end());
        for (const auto& [number, p] : group) {
            poll(execution_.progress, round++);
            if (std::binary_search(known.begin(), known.end(), p)) continue;
            edge.points.push_back(p);
            is_new = true;
        }
    }
    return is_new;
}

/// Points on the edges of a facet go to all that is near it, until all have them.
void Snapping::spread_points() {
    std::vector<std::int32_t> facets;
    for (std::size_t f = 0; f < places_.size(); ++f) {
        if (!places_[f].near.empty()) facets.push_back(static_cast<std::int32_t>(f));
    }
    const auto take = [&](std::size_t begin, std::size_t end, std::vector<OnEdge>& on_edges) {
        for (std::size_t i = begin; i < end; ++i)
            take_points(facets[i], on_edges);
    };
    while (add_points(collect_ranges<OnEdge>(facets.size(), kTrianglesAtOnce, execution_, take))) {
    }
}

/// Gives a facet the new points on the edges of those near it.
void Snapping::take_points(std::int32_t facet, std::vector<OnEdge>& on_edges) {
    NearFacet& place = places_[index(facet)];
    const TriangleCorners& t = facets_[facet];
    spatial::Box box = pieces_.box(t);
    box.widen(wide_.distance_at(pieces_.largest_coordinate()));
    for (const std::int32_t near : place.near) {
        const Nearness& pair_nearness = nearness({facet, near});
        const double within = pair_nearness.distance_of({t, facets_[near]});
        for (const std::int32_t e : places_[index(near)].edges) {
            const DividedEdge& edge = on_edges_[index(e)];
            for (std::size_t i = edge.old; i < edge.points.size(); ++i) {
                const SpacePointId p = edge.points[i];
                if (!box.contains(pieces_.points.rounded(p)) || has(t, p)) continue;
                const auto at = std::lower_bound(place.seen.begin(), place.seen.end(), p);
                if (at != place.seen.end() && *at == p) continue;
                place.seen.insert(at, p);
                bool is_on_edge = false;
                for (const std::int32_t facet_edge : place.edges) {
                    if (!pair_nearness.is_near_edge(p, edges_[facet_edge], within)) continue;
                    on_edges.emplace_back(facet_edge, p);
                    is_on_edge = true;
                }
                if (!is_on_edge && pair_nearness.is_over(p, t, within)) place.over.push_back(p);
            }
        }
    }
}

void Snapping::order_points() {
    const auto& points = pieces_.points;
    parallel_ranges(on_edges_.size(), kPairs, execution_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            const SpaceEdge& edge = edges_[static_cast<std::int32_t>(e)];
            auto& on = on_edges_[e].points;
            const std::size_t axis = edge_axis(points, edge[0], edge[1]);
            const bool grows = points.rounded(edge[0])[axis] < points.rounded(edge[1])[axis];
            const auto at = [&](SpacePointId p) {
                return grows ? points.rounded(p)[axis] : -points.rounded(p)[axis];
            };
            std::sort(on.begin(), on.end(), [&](SpacePointId p, SpacePointId q) {
                return std::pair(at(p), p) < std::pair(at(q), q);
            });
            on.erase(std::unique(on.begin(), on.end(),
                                 [&](SpacePointId p, SpacePointId q) { return at(p) == at(q); }),
                     on.end());
        }
    });
    parallel_ranges(places_.size(), kPairs, execution_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            places_[f].seen = {};
            sort_unique(places_[f].over);
        }
    });
}

SpacePointId Snapping::merged(SpacePointId p) const {
    const auto merge = std::lower_bound(merged_.begin(), merged_.end(), p,
                                        [](const Merge& m, SpacePointId q) { return m.from < q; });
    return merge == merged_.end() || merge->from != p ? p : merge->to;
}

/// The points that an edge is to get, in the order along it.
std::span<const SpacePointId> Snapping::points_on(const SpaceEdge& edge) const {
    const std::int32_t number = edges_.find(edge);
    if (number < 0) return {};
    return on_edges_[index(number)].points;
}

const Snapping::NearFacet* Snapping::place_of(const TriangleCorners& in_order) const {
    const std::int32_t number = places_.empty() ? -1 : facets_.find(in_order);
    return number < 0 ? nullptr : &places_[index(number)];
}

bool Snapping::is_divided(const TriangleCorners& in_order) const {
    for (const SpaceEdge& edge : edges_of(in_order)) {
        if (!points_on(edge).empty()) return true;
    }
    const NearFacet* place = place_of(in_order);
    return place != nullptr && !place->over.empty();
}

std::vector<TriangleCorners> Snapping::divided(const TriangleCorners& in_order) const {
    FacetPoints facet{in_order, {}, {}, {}};
    std::vector<SpacePointId> all(in_order.begin(), in_order.end());
    for (std::size_t k = 0; k < 3; ++k) {
        const SpacePointId from = in_order[k], to = in_order[(k + 1) % 3];
        const auto on = points_on(unordered(from, to));
        auto& edge_points = facet.on_edges[k];
        edge_points.assign(on.begin(), on.end());
        if (to < from) std::reverse(edge_points.begin(), edge_points.end());
        append(all, edge_points);
    }
    if (const NearFacet* place = place_of(in_order)) {
        facet.within = place->over;
        append(all, facet.within);
        sort_unique(all);
        const auto has_point = [&all](SpacePointId p) {
            return std::binary_search(all.begin(), all.end(), p);
        };
        for (const std::int32_t near : place->near) {
            for (const std::int32_t number : places_[index(near)].edges) {
                const SpaceEdge& edge = edges_[number];
                SpacePointId last = edge[0];
                bool has_last = has_point(last);
                const auto want = [&](SpacePointId next) {
                    const bool has_next = has_point(next);
                    if (has_last && has_next) facet.wanted.push_back(unordered(last, next));
                    last = next;
                    has_last = has_next;
                };
                for (const SpacePointId p : on_edges_[index(number)].points)
                    want(p);
                want(edge[1]);
            }
        }
        sort_unique(facet.wanted);
    }
    return booleans::divided(pieces_.points, facet, execution_.progress);
}

/// The triangles of the inputs that may have one of the vertices, edges or facets that change.
std::vector<std::int32_t> Snapping::inputs_to_change() {
    std::vector<spatial::Box> boxes;
    for (const Merge& merge : merged_)
        boxes.emplace_back().include(pieces_.points.rounded(merge.from));
    for (std::size_t e = 0; e < on_edges_.size(); ++e) {
        if (on_edges_[e].points.empty()) continue;
        boxes.push_back(
            spatial::bounding_box(edges_[static_cast<std::int32_t>(e)],
                                  [&](SpacePointId p) { return pieces_.points.rounded(p); }));
    }
    for (std::size_t f = 0; f < places_.size(); ++f) {
        if (!places_[f].over.empty())
            boxes.push_back(pieces_.box(facets_[static_cast<std::int32_t>(f)]));
    }
    auto inputs = collect_ranges<std::int32_t>(
        boxes.size(), kTrianglesAtOnce, execution_,
        [&](std::size_t begin, std::size_t end, std::vector<std::int32_t>& near) {
            for (std::size_t i = begin; i < end; ++i)
                pieces_.find_inputs(boxes[i], [&](std::int32_t input) { near.push_back(input); });
            sort_unique(near);
        });
    parallel_sort(inputs, std::less<>(), execution_);
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    return inputs;
}

std::vector<std::int32_t> Snapping::apply() {
    pieces_.moved_by(moved_ + 4 * ulp(pieces_.largest_coordinate()));
    const auto inputs = inputs_to_change();
    std::vector<std::vector<TrianglePiece>> made(inputs.size());
    std::vector<std::uint8_t> is_changed(inputs.size(), 0);
    const auto change = [&](std::size_t i) {
        for (const TrianglePiece& piece : pieces_.of(inputs[i])) {
            TrianglePiece merged_piece = piece;
            for (SpacePointId& p : merged_piece.corners)
                p = merged(p);
            if (merged_piece.corners != piece.corners) {
                merged_piece.is_fresh = true;
                is_changed[i] = 1;
            }
            if (has_equal_corners(merged_piece.corners)) continue;
            const auto [corners, is_odd] = in_order(merged_piece.corners);
            if (!is_divided(corners)) {
                made[i].push_back(merged_piece);
                continue;
            }
            is_changed[i] = 1;
            for (TriangleCorners t : divided(corners)) {
                if (is_odd) std::swap(t[1], t[2]);
                if (!has_equal_corners(t)) made[i].push_back({t, true});
            }
        }
        if (is_changed[i] != 0) {
            cancel_folds(made[i]);
        } else {
            made[i] = {};
        }
    };
    parallel_chunks(inputs.size(), execution_, change);
    std::vector<std::int32_t> changed;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (is_changed[i] == 0) continue;
        pieces_.replace(inputs[i], std::move(made[i]));
        changed.push_back(inputs[i]);
    }
    return changed;
}

}  // namespace realmodel::booleans
