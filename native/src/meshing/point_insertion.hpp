// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point that a triangle asks for lies, and what adding it would disturb.
#pragma once

#include <optional>
#include <vector>

#include "base/vectors.hpp"
#include "meshing/flat_mesh.hpp"

namespace realmodel::meshing {

/// Where a straight walk through a mesh ended.
struct Arrival {
    enum Kind { kInside, kOnEdge, kAtFixedEdge, kNowhere } kind;
    HalfEdge edge;  ///< of the triangle (inside), the edge it lies on, or the fixed edge in the way
};

/// Goes from within a triangle straight to a goal, and stops at the first fixed edge. `kNowhere`:
/// a vertex is there already, or the triangle is too thin for the question to have an answer.
Arrival walk_to(const FlatMesh& mesh, std::int32_t triangle, const PlanPoint& goal);

/// The center of the circle through a triangle's corners; none where doubles do not hold it.
std::optional<PlanPoint> circumcenter(const FlatMesh& mesh, std::int32_t triangle);

/// Finds a fixed edge that a new point would encroach on: that it would see, without another edge
/// between, under more than 120 degrees (Shewchuk 2002, section 3.4: lenses of 30 degrees).
class Encroachment {
public:
    /// Outside where there is none. `at` is where the point lies.
    HalfEdge find(const FlatMesh& mesh, const Arrival& at, const PlanPoint& p);

private:
    std::vector<std::int32_t> cavity_;
};

/// Whether an edge can be cut at a point near it without turning a triangle over. Exact.
bool can_cut(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p);

inline PlanPoint middle(const PlanPoint& a, const PlanPoint& b) {
    return moved(a, 0.5, minus(b, a));
}

}  // namespace realmodel::meshing
