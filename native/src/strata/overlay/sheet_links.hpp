// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "strata/overlay/envelope.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

/// A whole triangle between two nodes.
struct WholeFace {
    static constexpr std::int32_t kUnset = -2;
    std::int32_t above = kUnset, below = kUnset;  ///< nodes, or kOutsideCell
    std::int32_t surface = -1;                    ///< number of the surface that it is of

    bool is_set() const { return below != kUnset; }
    bool is_face() const { return is_set() && (above >= 0 || below >= 0); }
};

/// What the overlays of blocks leave of whole triangles, in all rock masses.
struct WholeTriangles {
    std::vector<WholeFace> face;  ///< of each plane
    /// Of each plane: looked at more closely than by bounds, or beside a border.
    std::vector<std::uint8_t> is_exact;
    std::vector<std::uint8_t> is_in_parts;  ///< of each plane: divided into several faces
    std::vector<std::uint8_t> is_added;     ///< of each plane: among the conforming faces
    struct BaseFace {
        PlaneId plane, base;
        std::int32_t node;
    };
    std::vector<BaseFace> on_base;  ///< beneath whole triangles

    explicit WholeTriangles(std::size_t planes)
        : face(planes), is_exact(planes), is_in_parts(planes), is_added(planes) {}
    WholeFace& of(PlaneId plane) { return face[index(plane)]; }
    const WholeFace& of(PlaneId plane) const { return face[index(plane)]; }
};

/// Facets that bounds sorted above a surface: the nodes beneath the triangles come first, one after
/// another, then those beneath the parts.
struct SealedFacets {
    std::int32_t first_node = 0;
    std::vector<PlaneId> wholes;
    std::vector<std::size_t> parts;  ///< of the envelope's
};

/// Links sealed facets with the surface beneath them, which they were never overlaid with.
/// Neighboring triangles of facets are connected, and so are the triangles beneath them: one link
/// for each connected part of them is enough.
/// @param filter  which compared `tiling` with the facets
/// @param node_above  of each triangle of the tiling that is below
void link_sheets(exact::PlanArrangement& geometry, const TriangleLinks& links,
                 const WholeTriangleFilter& filter, const BlockTiling& tiling,
                 const std::vector<std::int32_t>& node_above, const SealedFacets& sealed,
                 const Envelope& parts, const WholeTriangles& wholes, Construction& construction,
                 const Execution& execution);

}  // namespace realmodel::strata
