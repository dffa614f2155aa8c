// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {

/// Three edges that cross a third of the way along x and y, far from the origin: no doubles are
/// there, and the nearest ones lie beside all but the first edge.
struct ThreeLinesThroughAThird {
    ThreeLinesThroughAThird() { g.freeze_vertices(); }
    VertexId at(double x, double y) { return g.add_vertex(4e6 + x, 4e6 + y); }

    PlanArrangement g;
    const VertexId a = at(0, 0), b = at(1, 1), c = at(0, 1), d = at(0.5, 0), e = at(1, 0),
                   f = at(0, 0.5);
    DirectedLine one = g.add_edge(a, b), two = g.add_edge(c, d), three = g.add_edge(e, f);
};

}  // namespace realmodel::exact
