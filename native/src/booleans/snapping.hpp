// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <set>
#include <vector>

#include "booleans/pieces.hpp"

namespace realmodel::booleans {

/// Two triangles, by their corners in order.
using FacetPair = std::array<Corners, 2>;

/// Brings together what is closer than rounding can keep apart, where pieces meet out of order:
/// vertices become one, edges and triangles get the vertices that are near them, and edges that
/// pass each other get a common one. All pieces with such an edge or vertex follow, so that nothing
/// gapes.
///
/// This is how points are rounded (in the manner of V. Milenkovic and E. Sacks, "Geometric rounding
/// and feature separation in meshes", 2019): what is on which side of what was decided before,
/// exactly.
class Snapping {
public:
    /// @param ulps  how near, in units in the last place of the largest coordinate of a pair
    Snapping(Pieces& pieces, std::vector<FacetPair>&& pairs, double ulps);

    /// Folds triangles without area onto their longest edges: the corner across it becomes a vertex
    /// of all that have the edge, and the triangle is gone.
    Snapping(Pieces& pieces, const std::vector<Corners>& flat);

    /// Whether something of a pair is so near to the other one; pairs() has them in order.
    const std::vector<FacetPair>& pairs() const { return pairs_; }
    const std::vector<bool>& is_near() const { return is_near_; }

    /// Whether vertices become one: then this is all that apply() does.
    bool merges() const { return !merged_.empty(); }
    /// Changes the pieces; those that change are fresh.
    /// @return the triangles of the inputs whose pieces have changed, in order
    std::vector<std::int32_t> apply(int threads, const Progress* progress);

private:
    struct Addition {
        std::vector<SpacePointId> within;
        std::vector<Corners> near;  ///< triangles whose edges it is to get
    };
    double distance_of(const FacetPair& pair) const;
    std::vector<FacetPair> pairs_near(std::vector<Corners>& facets);
    void add_vertex(SpacePointId p);
    bool find_merges(const FacetPair& pair);
    void merge_vertices();
    bool find_near(const FacetPair& pair);
    bool is_near_edge(SpacePointId p, const Edge& edge, double within) const;
    bool find_near_edges(SpacePointId p, const Corners& t, double within);
    void find_crossing(const Edge& e, const Edge& f, double within, bool& found);
    SpacePointId vertex_near(const exact::SpacePosition& at, double within);
    bool is_between(SpacePointId p, const Edge& edge) const;
    bool is_over(SpacePointId p, const Corners& t, double within) const;
    void spread_points();
    void order_points();
    SpacePointId merged(SpacePointId p) const;
    std::vector<Corners> divided(const Corners& in_order) const;
    std::vector<SpacePointId> points_between(SpacePointId from, SpacePointId to) const;

    Pieces& pieces_;
    std::vector<FacetPair> pairs_;
    std::vector<bool> is_near_;
    double ulps_ = 0;
    std::map<SpacePointId, SpacePointId> merged_;  ///< what becomes another vertex
    std::set<Corners> asked_;                      ///< triangles whose neighbors are known
    std::set<SpacePointId> vertices_;              ///< of all pairs
    std::multimap<double, SpacePointId> by_x_;     ///< these and new ones
    std::vector<Edge> same_;                       ///< vertices that are to become one
    std::map<Edge, std::vector<SpacePointId>> on_edges_;
    std::map<Corners, Addition> additions_;
    double moved_ = 0;  ///< how far at most
};

}  // namespace realmodel::booleans
