// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutting/pieces.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

/// Which cell of a half each piece belongs to on either side: counted through both halves, -1 none.
using PieceParts = std::vector<std::array<std::int32_t, 2>>;

/// A cell of a half: the model's cell that it is or is part of, and the half.
struct HalfCell {
    std::int32_t cell;
    std::int8_t side;
};

/// Puts both halves and the section together. `positions` are the model's vertices and the new
/// nodes after them.
Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const Pieces& pieces, const PieceParts& parts,
                    const std::vector<HalfCell>& half_cells, int threads, Progress* progress);

/// The pieces that lie on the cutter, each turned as it is seen from above.
Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const Pieces& pieces);

}  // namespace realmodel::cutting
