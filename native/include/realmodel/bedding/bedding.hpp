// SPDX-License-Identifier: GPL-3.0-or-later
// Where corners of polygons of a model lie in their layers as they were deposited, for pictures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/strata/stack.hpp"
#include "realmodel/triangle_view.hpp"

namespace realmodel::bedding {

/// The history of one rock mass, or of one of its compartments: a sheet of each surface.
struct History {
    std::vector<TriangleView> sheets;  ///< oldest first
    std::vector<strata::Rule> rules;   ///< one a sheet; none at all means all erosional
    std::optional<double> base_elevation;
};

/// A face of a complex as one of its two cells sees it.
struct BedPolygon {
    std::int32_t face;
    bool reversed;         ///< seen from its second cell: the corners go the other way round
    std::int32_t history;  ///< of the cell
    std::int32_t layer;    ///< the cell's block lies beneath this sheet; -1: in no layer (a body)
};

/// One value for each corner, polygon after polygon.
struct Bedding {
    Array<float> height;     ///< 0 at the base of the layer, 1 at its top, as it was deposited
    Array<float> thickness;  ///< of the layer there as it was deposited, model units
    Array<float> depth;      ///< below the youngest top there, model units
};

/// At a plan position, going forward in time, sheet k is laid on top T_k: the layer beneath it is
/// deposited from T_k to e_k (docs/dev/geometry.md), whatever is eroded later. So its height at z
/// is (z - T_k) / (e_k - T_k), cut off at 0 and 1. Where the layer has no thickness it is 1 on
/// polygons that face upwards, 0 downwards, 1/2 on upright ones. Depth is what lies between z and
/// the last top. Bodies change none of this.
///
/// Heights of sheets are rounded; the same for all polygons that meet in a plan position, so values
/// go on across cuts. Where a sheet has a border or a step, each polygon gets that of its own side.
/// The same for any number of threads.
/// @param histories_of_corners  where not empty: of each corner, in place of its polygon's
/// @throws InputError kind bad_index (items: the polygon), where numbers are out of range
/// @throws Cancelled
Bedding bedding_of(const ComplexView& complex, std::span<const History> histories,
                   std::span<const BedPolygon> polygons,
                   std::span<const std::int32_t> histories_of_corners,
                   const Execution& execution = {});

}  // namespace realmodel::bedding
