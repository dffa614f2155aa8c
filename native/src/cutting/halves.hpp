// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutting/pieces.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

class WholePieces;

/// Puts both halves and the section together. `new_positions` are those of the nodes after the
/// model's vertices.
Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells,
                    const Execution& execution);

/// The pieces that lie on the cutter, each as it is seen from above.
Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const CutPieces& pieces);

}  // namespace realmodel::cutting
