// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/counting_sort.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::validation {

/// A face seen from one of its cells: `face * 2 + side`. From the second cell its loop runs the
/// other way.
using Side = std::uint32_t;
inline std::size_t face_of(Side side) {
    return side >> 1;
}
inline bool is_reversed(Side side) {
    return (side & 1) != 0;
}

/// The sides of every cell, ascending.
struct SidesByCell : Buckets<Side> {
    SidesByCell(const ComplexView& model, const Execution& execution);
};

}  // namespace realmodel::validation
