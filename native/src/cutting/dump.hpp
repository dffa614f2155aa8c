// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/rounding/rounded_parts.hpp"

// Pictures for whoever looks for an error, as strata/dump.hpp has them of stacks:
//   call realmodel::cutting::dump_parts(parts, "/tmp/parts.obj")

namespace realmodel::cutting {

/// The polygons around each part, in a group each, seen from outside of it.
void dump_parts(const RoundedParts& parts, const char* path);

}  // namespace realmodel::cutting
