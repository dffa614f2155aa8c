// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// Vertices in the place of an earlier one, and vertices of no face.
Findings check_vertices(const ComplexView& model, const Execution& execution);

/// Faces that name a vertex twice.
Findings check_loops(const ComplexView& model, const Execution& execution);

}  // namespace realmodel::validation
