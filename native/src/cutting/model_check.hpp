// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

/// Checks that arrays which may come from anywhere name only what is there.
/// @throws InputError kind bad_model
void check_model(const ComplexView& model);

}  // namespace realmodel::cutting
