// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/envelope.hpp"

#include <cmath>

#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

void check_nodes(std::int64_t count) {
    if (count > INT32_MAX) {
        throw InputError("too_large",
                         "the model has more than 2147 million cells; use coarser surfaces");
    }
}

std::int32_t Construction::add_node(std::int32_t block, bool is_thick) {
    const auto node = static_cast<std::int64_t>(node_block.size());
    check_nodes(node + 1);
    node_block.push_back(block);
    node_is_thick.push_back(is_thick ? 1 : 0);
    return static_cast<std::int32_t>(node);
}

void Construction::seal(const Envelope& envelope, std::size_t facet, std::int32_t node) {
    const auto [begin, end] = envelope.faces_of(facet);
    for (std::size_t f = begin; f < end; ++f) {
        if (node < 0 && envelope.face_above[f] < 0) continue;
        faces.add(envelope.face_polygons[f], envelope.plane[facet], envelope.surface[facet],
                  envelope.face_above[f], node);
    }
}

void Construction::count_blocks_from(std::size_t first_node, std::int32_t first_block) {
    for (std::size_t n = first_node; n < node_block.size(); ++n)
        node_block[n] += first_block;
}

Envelope initial_envelope(const SurfaceTiling& tiling, std::int32_t number) {
    Envelope envelope;
    for (std::size_t p = 0; p < tiling.plane.size(); ++p) {
        const bool surface = tiling.plane[p].has_value();
        const PlaneId plane = tiling.plane[p] == kVoid ? kSky : tiling.plane[p];
        envelope.add_facet(tiling.polygons[p], plane, surface ? number : -1, surface ? number : -1);
        if (surface) envelope.add_face(tiling.polygons[p], kOutsideCell);
    }
    return envelope;
}

std::array<double, 3> lowest_position(const exact::PlanArrangement& geometry,
                                      const Envelope& envelope) {
    LocalArrangement scope(geometry);
    std::array<double, 3> lowest{0, 0, HUGE_VAL};
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        if (!envelope.plane[f].has_value()) continue;
        for (const Corner& corner : envelope.outlines[f]) {
            const double z = scope.rounded_height(envelope.plane[f], corner.point);
            if (z >= lowest[2]) continue;
            const auto [x, y] = scope.rounded(corner.point);
            lowest = {x, y, z};
        }
    }
    return lowest;
}

void finish(const Envelope& envelope, std::optional<PlaneId> base, bool is_thick,
            Construction& construction) {
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        std::int32_t node = kOutsideCell;
        if (base && envelope.block_beneath[f] == 0) {
            node = construction.add_node(0, is_thick);
            construction.faces.add(envelope.outlines[f], *base, -1, node, kOutsideCell);
        }
        construction.seal(envelope, f, node);
    }
}

}  // namespace realmodel::strata
