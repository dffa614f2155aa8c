// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_extent.hpp"

#include <algorithm>
#include <cmath>

#include "validation/face_shape.hpp"

namespace realmodel::validation {

CellExtent::CellExtent(const ComplexView& model, std::span<const Side> sides) {
    low_.fill(HUGE_VAL);
    high_.fill(-HUGE_VAL);
    for (const Side side : sides) {
        for (const std::int32_t v : model.face(face_of(side))) {
            const auto p = model.vertex(v);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low_[axis] = std::min(low_[axis], p[axis]);
                high_[axis] = std::max(high_[axis], p[axis]);
            }
        }
    }
}

bool CellExtent::is_flat() const {
    return low_[0] == high_[0] || low_[1] == high_[1] || low_[2] == high_[2];
}

// What moves by a step in x sweeps no more than the cell is wide in y and high in z, and so on.
double CellExtent::volume_rounding() const {
    std::array<double, 3> size, step;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        step[axis] = last_place(std::max(std::abs(low_[axis]), std::abs(high_[axis])));
        size[axis] = high_[axis] - low_[axis] + step[axis];
    }
    return kRoundingSteps * (step[0] * size[1] * size[2] + size[0] * step[1] * size[2] +
                             size[0] * size[1] * step[2]) +
           0x1p-1000;  // what underflows
}

std::array<double, 3> CellExtent::middle() const {
    return {low_[0] + (high_[0] - low_[0]) / 2, low_[1] + (high_[1] - low_[1]) / 2,
            low_[2] + (high_[2] - low_[2]) / 2};
}

}  // namespace realmodel::validation
