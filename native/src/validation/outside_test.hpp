// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// Faces of one cell with another face of one cell in the same place: there the outside does not
/// begin, the two are one face that was stored twice. (Where their corners differ, sampling finds
/// them.)
Findings check_outside(const ComplexView& model, const Execution& execution);

}  // namespace realmodel::validation
