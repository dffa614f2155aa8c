// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Pieces of a surface that lie below the envelope.
struct LoweredPieces {
    PolygonPool outlines;
    GrowingArray<std::int32_t> polygon;     ///< of the layer
    GrowingArray<std::int32_t> cell_above;  ///< or kOutsideCell
};

/// Adds the facets of surface `number` to the envelope, in order of the layer's polygons. One that
/// lies below the envelope all over (`whole`) becomes one facet again with the pieces as its faces,
/// so that the overlay does not compound; of others each piece is a facet.
void add_surface_facets(const SurfaceTiling& layer, const std::vector<std::uint8_t>& whole,
                        const LoweredPieces& lowered, std::int32_t number, Envelope& next,
                        int threads, const Progress* progress);

}  // namespace realmodel::strata
