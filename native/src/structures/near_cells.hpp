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

    /// Of cells: 1 where they come near structures, or are beside cells that do, on the sides that
    /// are asked for.
    std::vector<std::uint8_t> that_may_be_in(const ComplexView& model, const Sides& sides,
                                             const Progress* progress) const;

private:
    std::vector<std::uint8_t> near(const ComplexView& model, const Progress* progress) const;
    bool is_on(const cutting::Position& p, const Sides& sides) const;

    const StructureSurface& surface_;
    int threads_;
    spatial::BoxTree tree_;
    std::vector<cutting::NearestSide> nearest_;
};

}  // namespace realmodel::structures
