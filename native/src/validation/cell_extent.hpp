// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "realmodel/complex.hpp"
#include "validation/cell_sides.hpp"

namespace realmodel::validation {

/// The box around a cell.
class CellExtent {
public:
    CellExtent(const ComplexView& model, std::span<const Side> sides);

    /// Whether the cell has no extent along an axis.
    bool is_flat() const;
    /// How far rounding its coordinates may have changed its volume.
    double volume_rounding() const;
    std::array<double, 3> middle() const;

private:
    std::array<double, 3> low_, high_;
};

}  // namespace realmodel::validation
