// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "chance.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Heights over the lattice.
enum class Height {
    kPlane,  ///< small integer slopes: equal over areas whatever the triangulations are
    kIntegers,
    kLevel,
    kFolded,  ///< the lower or the higher of two planes at each corner
    kWaves,
    kDecimals,  ///< three decimals, as a grid file has them
    kRandom,
    kMagnitudes  ///< 1e-6 beside 1e6
};

using HeightFunction = std::function<double(double x, double y)>;

/// The function draws from the chance whenever it is called.
HeightFunction make_height(Chance& chance, Height height);

// What surfaces come with. All keep the surface as it is but for what they say.

/// A neighbouring double; beside zero mostly a number of the size of rounding errors.
double nudged(Chance& chance, double value, int direction = 0);

void nudge_heights(Chance& chance, Mesh& mesh);
void nudge_plan(Chance& chance, Mesh& mesh);

/// Lifts triangles by whole numbers; corners are doubled there.
void add_jumps(Chance& chance, Mesh& mesh);

/// Adds triangles without area.
void add_flat_triangles(Chance& chance, Mesh& mesh);

/// Permutes vertices and triangles, turns triangles round, doubles vertices.
void disorder(Chance& chance, Mesh& mesh);

/// Gives every triangle corners of its own.
void unweld(Mesh& mesh);

}  // namespace realmodel::fuzz
