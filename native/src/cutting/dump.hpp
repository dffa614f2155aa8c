// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/rounding/rounded_parts.hpp"
#include "cutting/surface_overlay.hpp"

// Pictures for whoever looks for an error, as strata/dump.hpp has them of stacks:
//   call realmodel::cutting::dump_parts(parts, "/tmp/parts.obj")

namespace realmodel::cutting {

/// The regions of a model's faces near a surface, and those of the surface, in a group each: every
/// outline and every hole as a polygon.
void dump_overlay(const SurfaceOverlay& overlay, const char* path);

/// The polygons around each part, in a group each, seen from outside of it.
void dump_parts(const RoundedParts& parts, const char* path);

}  // namespace realmodel::cutting
