// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "cutting/nearest_side.hpp"
#include "structures/structure_surface.hpp"

namespace realmodel::structures {

/// Tells which cells of a model need not be looked at, as they are in other parts of space than it.
class NearCells {
public:
    NearCells(const StructureSurface& surface, int threads);

    /// Of cells: kNear where they come near a structure and are not on the wrong side of another,
    /// kInside where they come near none and are on the sides that are asked for, kElsewhere.
    enum Place : std::uint8_t { kElsewhere, kInside, kNear };
    std::vector<std::uint8_t> places_of(const ComplexView& model, const Sides& sides,
                                        const Progress* progress) const;

private:
    /// A structure by itself.
    struct Single {
        spatial::BoxTree tree;
        cutting::NearestSide side;
    };

    const StructureSurface& surface_;
    int threads_;
    double margin_;
    std::vector<Single> singles_;
};

}  // namespace realmodel::structures
