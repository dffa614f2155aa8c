// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/validation/sampling.hpp"

namespace realmodel::validation {

using PlanPosition = std::array<double, 2>;

/// A plan place where the model is compared with the closed form.
struct Probe {
    PlanPosition place{};
    std::int32_t wall = -1;  ///< which of the wall samples it lies beside, -1: none
    std::int32_t side = 0;   ///< of that wall: 0 the first cell's, 1 the second's
};

/// A point in a wall, well away from its ends.
struct WallSample {
    std::int32_t face = -1;
    PlanPosition middle{};
    PlanPosition from{}, to{};  ///< the stretch of the wall between two of its places
    double height = 0;          ///< of the point; in the middle of the wall there
    double half_width = 0;      ///< from there up and down to the wall's border
    double highest = 0;         ///< largest height of its corners, without its sign
};

/// Lengths that rounding makes: steps in the last place of the largest plan coordinate. Rounding
/// and what is done to the input first move a place by fewer than ten of them.
struct PlanRounding {
    double near = 0;  ///< closer to an edge than this, a place may lie on either side of it
    double step = 0;  ///< from a wall to the probes beside it
    explicit PlanRounding(double largest)
        : near(32 * largest * 0x1p-52), step(64 * largest * 0x1p-52) {}
};

struct Probes {
    std::vector<Probe> probes;
    std::vector<WallSample> walls;
    std::int64_t narrow_walls = 0;  ///< chosen, but too short to have two sides beyond rounding
};

/// The largest plan coordinate of a model and its input.
double largest_plan_coordinate(const ComplexView& model, const ModelInput& input);

/// Chooses the places; the same for the same seed.
Probes choose_probes(const ComplexView& model, const ModelInput& input, std::int64_t places,
                     std::uint64_t seed, const PlanRounding& rounding, Progress* progress);

}  // namespace realmodel::validation
