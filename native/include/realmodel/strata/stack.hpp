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

#include "realmodel/base/growing_array.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// A triangulated surface, single-valued in z: one row (x, y, z) a vertex, three indices a
/// triangle.
struct SurfaceView {
    std::span<const double> vertices;         ///< 3 V numbers, model units
    std::span<const std::int32_t> triangles;  ///< 3 T indices into the vertices, either orientation
};

/// A triangulation of the region in plan; only its border matters.
struct RegionView {
    std::span<const double> vertices;         ///< 2 V numbers
    std::span<const std::int32_t> triangles;  ///< 3 T indices
};

/// What a surface does to what is older, and to what is younger (docs/geometry.md).
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

/// One rock mass.
struct StackInput {
    std::vector<SurfaceView> surfaces;  ///< oldest first
    std::vector<Rule> rules;            ///< one a surface; none at all means all erosional
    std::optional<RegionView> region;
    std::optional<double> base_elevation;
};

/// What was left out of the input, and why.
struct Warning {
    std::string kind;
    int surface = -1;
    std::vector<std::int64_t> items;
    std::string text;
};

/// Polyhedral cells that share faces exactly (the layout that OpenFOAM calls owner / neighbour).
struct CellComplex {
    GrowingArray<std::array<double, 3>> vertices;
    GrowingArray<std::int64_t> face_offsets;
    GrowingArray<std::int32_t>
        face_vertices;  ///< counter-clockwise seen from outside the first cell
    GrowingArray<std::array<std::int32_t, 2>> face_cells;  ///< -1 is outside; the first never is
    GrowingArray<std::int32_t> face_surface;               ///< -1 a vertical wall, -2 the flat base
    /// The surface that the cell's block lies beneath; of the oldest surface of a rock mass: the
    /// block between it and the base. Surfaces are counted through all rock masses.
    GrowingArray<std::int32_t> cell_block;
    std::vector<double> volumes;  ///< of the block beneath each surface
    std::vector<Warning> warnings;
    std::uint64_t decisions = 0;        ///< how many signs were asked
    std::uint64_t exact_decisions = 0;  ///< how many of them needed exact arithmetic
};

/// What a cell is.
enum class CellKind {
    kColumns,  ///< what lies under one facet of the surface above it
    kBlocks    ///< a connected part of a block
};

inline constexpr std::int32_t kWall = -1;
inline constexpr std::int32_t kBase = -2;
/// What a cut laid bare (realmodel/cutting): it lies between the two halves.
inline constexpr std::int32_t kCutFace = -3;

/// Replays deposition and erosion: all blocks of rock masses, cell by cell, going down from the
/// youngest surface of each (docs/architecture.md). Where rock masses share a stretch of border the
/// wall between them is overlaid from both sides. Every decision is exact on the input; coordinates
/// are rounded once. The same input gives the same result for any number of threads.
/// @throws InputError kinds not_finite, bad_index, vertical_triangle, double_valued,
/// base_not_below,
///         rocks_overlap (items: the two rock masses), too_large; surfaces are counted through all
///         rock masses
/// @throws Cancelled
CellComplex build_rock_masses(std::span<const StackInput> rocks, int threads, Progress* progress,
                              CellKind cells = CellKind::kColumns);

/// The same of one rock mass.
CellComplex build_stack(const StackInput& input, int threads, Progress* progress,
                        CellKind cells = CellKind::kColumns);

}  // namespace realmodel::strata
