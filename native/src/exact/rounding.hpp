// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "exact/local_arrangement.hpp"

// Lines, planes and points in extended precision (64 bits of mantissa, as on x86), each with bounds
// on its errors. Enough to round nearly all coordinates at a fraction of what twice the precision
// of doubles costs. Where `long double` is no such type every bound is infinite, and the slower
// ways (double_double_interval.hpp, GMP) give the same doubles.
namespace realmodel::exact {

/// a x + b y + c relative to a plan vertex.
struct NearLine {
    ExtendedInterval a, b, c;
};
NearLine near_line(const PlanArrangement& geometry, const Line& line, VertexId origin);

/// The double nearest to `from` and a number close to `value`, or nothing where the bound on its
/// error leaves two to choose from.
std::optional<double> nearest_sum(double from, const ExtendedInterval& value);

/// The height of a plane above a point, likewise.
std::optional<double> near_height(const PlanArrangement& geometry, PlaneId plane,
                                  const NearPoint& point);

/// That of an input edge above a point of it: the same as that of every plane that stands on the
/// edge, in a third of the time.
std::optional<double> near_edge_height(const PlanArrangement& geometry, SpaceId from, SpaceId to,
                                       const NearPoint& point);

/// LocalArrangement::line_key of a line relative to the origin of the keys, likewise.
std::optional<std::array<double, 3>> near_line_key(const NearLine& line);

}  // namespace realmodel::exact
