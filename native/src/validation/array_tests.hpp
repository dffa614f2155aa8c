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

/// Vertices in the place of an earlier one, and vertices of no face.
Findings check_vertices(const ComplexView& model, const Execution& execution);

/// Faces that name a vertex twice.
Findings check_loops(const ComplexView& model, const Execution& execution);

/// Faces of one cell with another face of one cell in the same place: there the outside does not
/// begin, the two are one face that was stored twice. (Where their corners differ, sampling finds
/// them.)
Findings check_outside(const ComplexView& model, const Execution& execution);

}  // namespace realmodel::validation
