// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/triangle_view.hpp"

namespace realmodel::strata {

/// What a surface does to what is older, and to what is younger (docs/dev/geometry.md).
enum class Rule {
    kErosional,     ///< cuts what is older
    kConformable,   ///< only deposits: ends where it meets what is there
    kBase,          ///< only deposits, and may not be cut by what is younger (baselap)
    kDiscontinuous  ///< cuts, and may not be cut
};

/// A rule's name in files, whether it cuts what is older, and whether what is younger may not cut
/// it.
struct RuleMeaning {
    std::string_view name;
    bool cuts, protects;
};
/// In the order of Rule.
inline constexpr RuleMeaning kRules[] = {{"erosional", true, false},
                                         {"conformable", false, false},
                                         {"base", false, true},
                                         {"discontinuous", true, true}};
constexpr const RuleMeaning& meaning(Rule rule) {
    return kRules[static_cast<std::size_t>(rule)];
}
/// The rule of a name, or nothing.
constexpr std::optional<Rule> rule_named(std::string_view name) {
    for (std::size_t rule = 0; rule < std::size(kRules); ++rule) {
        if (kRules[rule].name == name) return static_cast<Rule>(rule);
    }
    return std::nullopt;
}

/// A rectangle in plan.
struct Window {
    double low_x, low_y, high_x, high_y;
};

/// One rock mass.
struct StackInput {
    std::vector<TriangleView> surfaces;  ///< oldest first, each single-valued in z
    std::vector<Rule> rules;             ///< one a surface; none at all means all erosional
    std::optional<TriangleView> region;  ///< in plan; only its border matters
    std::optional<double> base_elevation;
    /// Surfaces, ascending: before each of them all that is there becomes air, and only what was
    /// protected stays so. Of models of columns without a base elevation.
    std::vector<std::size_t> emptied;
    /// Of each surface before the last of `emptied` 1 where it is the top of a body: then what is
    /// below the oldest surface stays as it is, but for places at which a body was there first.
    /// None at all: nothing stays.
    std::vector<std::uint8_t> fills;
    /// What lies beyond it is left out, as beyond the region.
    std::optional<Window> window = {};
};

/// Where in space anything is wanted: in some cells of a grid of at most 64 layers.
struct WantedSpace {
    std::array<double, 3> low, step;          ///< the least corner, the size of a cell
    std::array<std::size_t, 3> cells;         ///< how many along each axis
    std::span<const std::uint8_t> is_wanted;  ///< of each cell, the last axis fastest: 0 it is not
};

using realmodel::CellComplex;
using realmodel::CellKind;
using realmodel::kBase;
using realmodel::kCutFace;
using realmodel::kWall;
using realmodel::Warning;

/// Replays deposition and erosion: all blocks of rock masses, cell by cell, going down from the
/// youngest surface of each (docs/dev/architecture.md). Where rock masses share a stretch of border
/// the wall between them is overlaid from both sides. Every decision is exact on the input;
/// coordinates are rounded once. The same input gives the same result for any number of threads.
/// @param wanted  of columns: those that lie nowhere in it may be left out, and volumes are 0
/// @param is_local  of columns: edges have all vertices that lie on them, whether any face needs
///                  them there or not, so that what is somewhere follows from what is near
/// @throws InputError kinds not_finite, bad_index, vertical_triangle, double_valued,
///         base_not_below and bad_region (items: the rock mass), rocks_overlap (items: the two rock
///         masses), too_large; surfaces are counted through all rock masses
/// @throws Cancelled
CellComplex build_rock_masses(std::span<const StackInput> rocks, const Execution& execution,
                              CellKind cells = CellKind::kColumns,
                              const WantedSpace* wanted = nullptr, bool is_local = false);

/// A vertex of a tile on a line that bounds it.
struct BorderVertex {
    std::int32_t vertex;
    std::array<double, 3> nearest;  ///< the doubles nearest to where it is exactly
    /// Where it is exactly: reduced fractions, hexadecimal. Equal points have equal ones in all
    /// tiles.
    std::array<std::string, 3> exact;
};

/// What of rock masses lies in a window, and its vertices on the lines that bound it, by number.
struct Tile {
    CellComplex complex;
    std::vector<BorderVertex> border;
};

/// What of rock masses lies in a window. No vertex but those in `border` has a coordinate of a
/// line. Borders are taken as they are: whoever divides a model has joined them in all of it
/// (find_joins), so that all its tiles have the same.
/// @throws as build_rock_masses
Tile build_tile(std::span<const StackInput> rocks, const Window& window, const Execution& execution,
                CellKind cells = CellKind::kColumns);

/// build_rock_masses of one.
CellComplex build_stack(const StackInput& input, const Execution& execution,
                        CellKind cells = CellKind::kColumns);

}  // namespace realmodel::strata
