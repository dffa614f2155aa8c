// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"
#include "validation/cell_sides.hpp"

namespace realmodel::validation {

/// What a face adds to the volumes of its two cells, each measured from a corner of that cell, so
/// that coordinates far from the origin cost no digits.
struct FaceMeasure {
    std::array<double, 2> volume{0, 0};
    /// How much a volume changes at most where every corner moves by a unit in the last place.
    double rounding = 0;
};

/// One pass over all faces, which fetches the corners of each once: whether it is a polygon as it
/// should be, and its share in volumes.
class FaceMeasures {
public:
    FaceMeasures(const ComplexView& model, const SidesByCell& sides, const Execution& execution);

    const FaceMeasure& operator[](std::size_t face) const { return measures_[face]; }
    Findings& findings() { return findings_; }

private:
    std::vector<FaceMeasure> measures_;
    Findings findings_;
};

}  // namespace realmodel::validation
