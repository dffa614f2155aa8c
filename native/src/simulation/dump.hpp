// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/cleaning/editable_complex.hpp"
#include "simulation/column_filler.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_levels.hpp"

// Pictures of what the steps work on, as strata/dump.hpp has them of the stack: nothing in the
// library calls these. From a debugger that has stopped at an assertion, e.g.
//   call realmodel::simulation::dump_plan(plan_, "/tmp/plan.obj")

namespace realmodel::simulation {

/// The planar mesh at height 0, in a group for each rock mass (or "outside"); as lines its edges on
/// steps, and on other lines.
void dump_plan(const PlanTopology& plan, const char* path);

/// The posts of all triangles: the levels of each as a line upward, moved a little to the middle of
/// its triangle, in a group "post_N" for each.
void dump_posts(const PlanTopology& plan, const PostLevels& levels, const char* path);

/// The elements of columns, in a group for each block: their lower and upper faces.
void dump_columns(const PlanTopology& plan, const PostLevels& levels, const ColumnFronts& columns,
                  const char* path);

/// The faces that a change removes, in a group "before", and those it adds, in one for each.
void dump_change(const EditableComplex& complex, const Change& change, const char* path);

}  // namespace realmodel::simulation
