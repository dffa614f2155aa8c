// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "complex_defects.hpp"

namespace realmodel::fuzz {

/// What the program's own check of a finished model (realmodel/validation) finds: it must call
/// every model right that the fuzzer's tests call right.
std::vector<Defect> second_opinion(const strata::CellComplex& complex, const StackCase& stack);

}  // namespace realmodel::fuzz
