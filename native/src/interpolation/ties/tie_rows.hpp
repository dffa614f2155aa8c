// SPDX-License-Identifier: GPL-3.0-or-later
// Heights in triangles, as sums of heights of nodes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/ties/tie_kernel.hpp"
#include "realmodel/interpolation/ties.hpp"

namespace realmodel::interpolation {

/// A height that is asked for in a triangle. corners: numbers of centers.
struct TieRow {
    std::array<std::int32_t, 3> corners{};
    std::array<double, 3> weights{};
    double lower = 0, upper = 0;
    double shortest_edge = 0;
    bool is_known = false;  ///< there is a triangle with heights

    bool is_contact() const { return lower == upper; }
    /// Linear in the triangle, as heights_on_surface has it.
    double value(std::span<const double> z) const {
        const double base = z[corners[0]];
        double sum = base;
        for (std::size_t k = 1; k < 3; ++k)
            sum += weights[k] * (z[corners[k]] - base);
        return sum;
    }
};

/// The rows of data, and their corners, the centers of kernels.
struct TieRows {
    std::vector<TieRow> rows;
    std::vector<Position> positions;  ///< of centers
    std::vector<double> sided, heights;
    std::size_t faults = 0;
    double area = 0;  ///< of the mesh

    TieRows(const TiedSheets& sheets, const TieData& data);

    SheetNode center(std::int32_t number) const {
        const auto i = static_cast<std::size_t>(number);
        return {positions[i], std::span(sided).subspan(i * faults, faults)};
    }
    /// The scalar product of two rows.
    double product(const TieRow& a, const TieRow& b, double radius) const;
};

}  // namespace realmodel::interpolation
