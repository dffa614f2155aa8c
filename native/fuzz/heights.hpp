// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "random_source.hpp"
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

/// The function draws random numbers whenever it is called.
HeightFunction make_height(RandomSource& random, Height height);

// What surfaces come with. All keep the surface as it is but for what they say.

/// A neighboring double; beside zero mostly a number of the size of rounding errors.
double nudged(RandomSource& random, double value, int direction = 0);

void nudge_heights(RandomSource& random, Mesh& mesh);
void nudge_plan(RandomSource& random, Mesh& mesh);

/// Lifts triangles by whole numbers; corners are doubled there.
void add_jumps(RandomSource& random, Mesh& mesh);

/// Adds triangles without area.
void add_flat_triangles(RandomSource& random, Mesh& mesh);

/// Permutes vertices and triangles, turns triangles round, doubles vertices.
void disorder(RandomSource& random, Mesh& mesh);

/// Gives every triangle corners of its own.
void unweld(Mesh& mesh);

}  // namespace realmodel::fuzz
