// SPDX-License-Identifier: GPL-3.0-or-later
// The roughness of a triangulated surface: how its slope changes across edges. Private.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/vectors.hpp"

namespace realmodel::interpolation {

/// An inner edge with the two triangles at it: (g . z of the four nodes)^2 is what it adds to the
/// roughness. g of a linear function is 0.
struct Hinge {
    std::array<std::int32_t, 4> nodes;
    std::array<double, 4> g;
    Place middle;                   ///< of the edge
    std::array<double, 3> bending;  ///< g . z for surfaces with the second derivatives xx, xy, yy
};

/// The hinges of a mesh; triangles may turn either way, those without area have none.
std::vector<Hinge> hinges(std::span<const Place> nodes,
                          std::span<const std::array<std::int32_t, 3>> triangles);

/// Rows of a symmetric sparse matrix.
class SparseRows {
public:
    /// The matrix of the roughness: z^T A z.
    SparseRows(std::size_t nodes, std::span<const Hinge> hinges, int threads);

    std::size_t size() const { return first_.size() - 1; }
    const Vector& diagonal() const { return diagonal_; }

    /// Sum of the magnitudes of a row.
    double magnitude(std::size_t row) const;

    /// Calls visit(column, value) for the entries of a row.
    template <class Visit>
    void for_entries(std::size_t row, Visit&& visit) const {
        for (std::size_t k = first_[row]; k < first_[row + 1]; ++k)
            visit(column_[k], value_[k]);
    }

    /// A x of one row.
    double times(std::size_t row, const double* x) const {
        double sum = 0;
        for (std::size_t k = first_[row]; k < first_[row + 1]; ++k)
            sum += value_[k] * x[column_[k]];
        return sum;
    }

private:
    std::vector<std::size_t> first_;
    std::vector<std::int32_t> column_;
    Vector value_;
    Vector diagonal_;
};

}  // namespace realmodel::interpolation
