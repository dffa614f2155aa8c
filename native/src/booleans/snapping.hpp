// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/key_table.hpp"
#include "base/vectors.hpp"
#include "booleans/nearness.hpp"
#include "booleans/triangle_pieces.hpp"

namespace realmodel::booleans {

using exact::SpacePointId;
using exact::SpacePoints;

inline double distance(const exact::SpacePosition& p, const exact::SpacePosition& q) {
    return length(minus(p, q));
}

/// Brings together what is closer than rounding can keep apart, where pieces meet out of order:
/// vertices become one, edges and triangles get the vertices that are near them, and edges that
/// pass each other get a common one. All pieces with such an edge or vertex follow, so that nothing
/// gapes.
///
/// This is how points are rounded (in the manner of V. Milenkovic and E. Sacks, "Geometric rounding
/// and feature separation in meshes", 2019). What crosses farther apart is decided exactly.
class Snapping {
public:
    /// How near, in units in the last place of the largest coordinate of two facets.
    struct Radius {
        double of_pairs;     ///< around the facets of the pairs
        double of_the_rest;  ///< where these have handed on vertices
    };
    /// @param pairs  facets that meet, in order
    Snapping(TrianglePieces& pieces, std::span<const FacetPair> pairs, const Radius& radius,
             const Execution& execution);

    /// Folds triangles without area onto their longest edges: the corner across it becomes a vertex
    /// of all that have the edge, and the triangle is gone.
    Snapping(TrianglePieces& pieces, std::span<const TriangleCorners> flat,
             const Execution& execution);

    /// Whether vertices become one: then this is all that apply() does.
    bool merges() const { return !merged_.empty(); }
    SpacePointId merged(SpacePointId p) const;
    /// Changes the pieces; those that change are fresh.
    /// @return the triangles of the inputs whose pieces have changed, in order
    std::vector<std::int32_t> apply();

private:
    struct Merge {
        SpacePointId from, to;
    };
    /// A facet that is near others.
    struct NearFacet {
        std::array<std::int32_t, 3> edges;
        std::vector<std::int32_t> near;  ///< facets whose edges it is to get, in order
        std::vector<SpacePointId> over;  ///< vertices that it is to get within, in order
        std::vector<SpacePointId> seen;  ///< vertices on edges of those facets, in order
    };
    /// Vertices that an edge is to get.
    struct DividedEdge {
        std::vector<SpacePointId> points;  ///< in the order along the edge in the end
        std::size_t old = 0;               ///< so many were there before the last pass
    };
    using FacetNumbers = std::array<std::int32_t, 2>;

    using Waves = std::vector<std::int32_t>;  ///< of facets: when asked what is around them, or -1

    const Nearness& nearness(std::int32_t facet) const {
        return index(facet) < first_ ? wide_ : narrow_;
    }
    const Nearness& nearness(const FacetNumbers& pair) const {
        return nearness(std::min(pair[0], pair[1]));
    }
    /// How far from a facet others may be near it.
    double reach(std::int32_t facet) const {
        return nearness(facet).distance_at(pieces_.largest_coordinate());
    }
    std::vector<FacetNumbers> pairs_around(std::span<const std::int32_t> facets, Waves& waves);
    std::vector<std::int32_t> find_near(std::span<const FacetNumbers> pairs, const Waves& waves,
                                        NearFeatures& all);
    void merge_vertices(const std::vector<SpaceEdge>& same);
    void place(NearFeatures&& features);
    void spread_points();
    using OnEdge = std::pair<std::int32_t, SpacePointId>;
    void take_points(std::int32_t facet, std::vector<OnEdge>& on_edges);
    bool add_points(std::vector<OnEdge>&& on_edges);
    void order_points();
    std::span<const SpacePointId> points_on(const SpaceEdge& edge) const;
    const NearFacet* place_of(const TriangleCorners& in_order) const;
    bool is_divided(const TriangleCorners& in_order) const;
    std::vector<TriangleCorners> divided(const TriangleCorners& in_order) const;
    std::vector<std::int32_t> inputs_to_change();

    TrianglePieces& pieces_;
    Nearness wide_, narrow_;
    Execution execution_;
    KeyNumbers<TriangleCorners> facets_;  ///< those of the pairs first
    std::size_t first_ = 0;               ///< so many
    KeyNumbers<SpaceEdge> edges_;         ///< of facets that are near others, and divided ones
    std::vector<FacetNumbers> near_;      ///< facets that are near one another
    std::vector<NearFacet> places_;       ///< of facets
    std::vector<DividedEdge> on_edges_;   ///< of edges
    std::vector<Merge> merged_;           ///< what becomes another vertex, in order
    double moved_ = 0;                    ///< how far at most
};

}  // namespace realmodel::booleans
