// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/simulation/layered_mesh.hpp"

namespace realmodel::simulation {

/// The rectangle of 10 by 6 in plan, whose middle line, x = 5, is a segment between its points 1
/// and 4.
inline PlanLines halves(bool is_step, std::int32_t left_rock = 0, std::int32_t right_rock = 0) {
    PlanLines lines;
    lines.points = {{0, 0}, {5, 0}, {10, 0}, {10, 6}, {5, 6}, {0, 6}};
    lines.segments = {{0, 1, left_rock, -1, true},           {1, 2, right_rock, -1, true},
                      {2, 3, right_rock, -1, true},          {3, 4, right_rock, -1, true},
                      {4, 5, left_rock, -1, true},           {5, 0, left_rock, -1, true},
                      {1, 4, left_rock, right_rock, is_step}};
    lines.ending_offsets.assign(lines.segments.size() + 1, 0);
    if (is_step) lines.steps = {{PlanPoint{5, 0}, PlanPoint{5, 6}}};
    return lines;
}

/// A fan of eight triangles over it: each half around a node in its middle.
inline meshing::PlanarMesh fans() {
    return {
        {{0, 0}, {5, 0}, {10, 0}, {10, 6}, {5, 6}, {0, 6}, {2.5, 3}, {7.5, 3}},
        {{0, 1, 6}, {1, 4, 6}, {4, 5, 6}, {5, 0, 6}, {1, 2, 7}, {2, 3, 7}, {3, 4, 7}, {4, 1, 7}}};
}

}  // namespace realmodel::simulation
