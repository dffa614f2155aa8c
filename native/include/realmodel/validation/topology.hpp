// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// The tests that need nothing but the cells themselves, of every cell, face and vertex: arrays,
/// closed, loops, vertices, faces, outside, volumes, block volumes (docs/dev/geometry.md says what
/// each means). Where `arrays` fails, it is the only one: the others would read out of range. The
/// same findings for any number of threads.
/// @throws Cancelled
std::vector<TestResult> check_topology(const ComplexView& model, const Execution& execution);

}  // namespace realmodel::validation
