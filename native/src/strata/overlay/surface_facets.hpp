// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/array.hpp"
#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Pieces of a surface that lie below the envelope.
struct PiecesBelow {
    PolygonPool outlines;
    Array<std::int32_t> polygon;     ///< of the tiling
    Array<std::int32_t> node_above;  ///< node, kOutsideCell or kLeftOut
};

/// The pieces of each polygon.
struct PiecesOfPolygons {
    Array<std::uint32_t> offsets;
    Array<std::uint32_t> pieces;  ///< ascending for each polygon

    std::span<const std::uint32_t> operator[](std::size_t polygon) const {
        return {pieces.begin() + offsets[polygon], pieces.begin() + offsets[polygon + 1]};
    }
};
/// @throws InputError kind too_large, where there are more pieces than numbers for them
PiecesOfPolygons sort_by_polygon(const PiecesBelow& below, std::size_t polygons,
                                 const Execution& execution);

/// What becomes of a polygon of the surface: one facet, one of each piece, or nothing here.
enum PolygonUse : std::uint8_t { kTogether, kDivided, kElsewhere };

/// Adds the facets of a surface to the envelope, in order of the tiling's polygons. One that
/// lies below the envelope all over becomes one facet again with the pieces as its faces, so that
/// the overlay does not compound; of divided ones each piece is a facet.
/// @param use  PolygonUse of each polygon
void add_surface_facets(const NumberedTiling& surface, const std::vector<std::uint8_t>& use,
                        const PiecesBelow& below, const PiecesOfPolygons& of_polygon,
                        Envelope& next, const Execution& execution);

}  // namespace realmodel::strata
