// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "booleans/facet_division.hpp"

namespace realmodel::booleans {

/// Two triangles, by their corners in order; the lesser first.
using FacetPair = std::array<TriangleCorners, 2>;

FacetPair pair_of(TriangleCorners one, TriangleCorners other);

/// What of two triangles is nearer than rounding can keep apart.
struct NearFeatures {
    /// Two edges that pass each other, and where.
    struct NearCrossing {
        SpaceEdge one, other;  ///< in order
        exact::SpacePosition at;
        double within;
        auto operator<=>(const NearCrossing&) const = default;
    };
    std::vector<SpaceEdge> same;  ///< vertices that are to become one
    std::vector<std::pair<SpaceEdge, SpacePointId>> on_edges;
    std::vector<std::pair<TriangleCorners, SpacePointId>>
        over;  ///< vertices over the inside of triangles
    std::vector<NearCrossing> crossings;

    /// Takes over the features of another one, which is empty then.
    void take(NearFeatures& other);
    void make_unique();
    bool empty() const {
        return same.empty() && on_edges.empty() && over.empty() && crossings.empty();
    }
};

/// What is near: within so many units in the last place of the largest coordinate of a pair, but no
/// more than 1e-9 of the largest one that both triangles reach, or so many units of that. Decided
/// in doubles (docs/dev/exactness.md, the rule of Booleans).
class Nearness {
public:
    Nearness(const SpacePoints& points, double ulps) : points_(points), ulps_(ulps) {}

    double distance_of(const FacetPair& pair) const;
    /// The largest one where no coordinate is larger than this.
    double distance_at(double coordinate) const;
    /// Adds what is near in a pair.
    void find(const FacetPair& pair, NearFeatures& features) const;
    /// Whether one of two triangles passes through the plane of the other by so little that all of
    /// it on one side of that plane is near the plane.
    bool is_shallow(const FacetPair& pair) const;

    bool is_near_edge(SpacePointId p, const SpaceEdge& edge, double within) const;
    bool is_over(SpacePointId p, const TriangleCorners& t, double within) const;
    /// Whether a point is between the ends of an edge, along its longest axis.
    bool is_between(SpacePointId p, const SpaceEdge& edge) const;

private:
    void find_same(const FacetPair& pair, double within, NearFeatures& features) const;
    void find_crossing(const SpaceEdge& e, const SpaceEdge& f, double within,
                       NearFeatures& features) const;
    bool passes_little(const TriangleCorners& triangle, const TriangleCorners& plane,
                       double within) const;

    const SpacePoints& points_;
    double ulps_;
};

inline std::array<SpaceEdge, 3> edges_of(const TriangleCorners& c) {
    return {unordered(c[0], c[1]), unordered(c[1], c[2]), unordered(c[2], c[0])};
}

}  // namespace realmodel::booleans
