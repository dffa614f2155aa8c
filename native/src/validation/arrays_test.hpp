// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// Whether the arrays fit together, so that the other tests may follow their numbers: lengths,
/// offsets, numbers in range, finite coordinates, two different cells to a face, faces to each
/// cell.
Findings check_arrays(const ComplexView& model, const Execution& execution);

}  // namespace realmodel::validation
