// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "complex_defects.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

struct JudgeOptions {
    std::size_t most_triangles = 250;  ///< of a case whose exact volumes are asked for
    std::size_t most_polygons = 3000;  ///< in plan, of the exact volumes; beyond, it goes without
    std::vector<int> threads{2};       ///< numbers of threads whose bytes are compared with one's
};

/// Takes out of a case what makes it no valid input, with the builder's own help; each of its
/// refusals is examined. What is wrong with one of them is returned; false in `usable` where
/// nothing is left.
std::vector<Defect> make_valid(StackCase& stack, bool& usable);

/// All defects of the models that are built of a valid case, as columns and as blocks; none where
/// all is well.
std::vector<Defect> defects_of(const StackCase& stack, const JudgeOptions& options = {});

/// How far each block volume may be off: 1e-9 of it, and the rounding of the coordinates
/// themselves.
std::vector<double> volume_allowance(const StackCase& stack, const std::vector<double>& volumes);

}  // namespace realmodel::fuzz
