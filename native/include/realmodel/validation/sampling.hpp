// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/strata/stack.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// What a model was built from.
struct ModelInput {
    std::span<const strata::StackInput> rocks;
    /// The block beneath each surface, counted through all rock masses; -1 where there is none.
    std::span<const std::int32_t> block_of_surface;
};

/// Compares a model with the closed form (docs/dev/geometry.md) at about `places` plan places:
/// spread evenly, in triangles of the input, on faces, and at either side of walls. At each the
/// whole column of the model is walked through; the closed form is decided exactly there. Tests:
/// places, surfaces, walls. The arrays must have passed check_topology. The same seed gives the
/// same places and findings for any number of threads.
/// @throws Cancelled, InputError (bad_index)
std::vector<TestResult> check_samples(const ComplexView& model, const ModelInput& input,
                                      std::int64_t places, std::uint64_t seed,
                                      const Execution& execution);

}  // namespace realmodel::validation
