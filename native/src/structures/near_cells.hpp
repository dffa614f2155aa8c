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

    /// Of cells: 1 where they are on the side that is asked for of every structure, or near it.
    std::vector<std::uint8_t> that_may_be_in(const ComplexView& model, const Sides& sides,
                                             const Progress* progress) const;

private:
    /// A structure by itself.
    struct Single {
        spatial::BoxTree tree;
        cutting::NearestSide side;
    };

    const StructureSurface& surface_;
    int threads_;
    std::vector<Single> singles_;
};

}  // namespace realmodel::structures
