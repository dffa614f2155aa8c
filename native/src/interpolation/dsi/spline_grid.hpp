// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {

/// Uniform biquadratic B-splines on square cells over a box. Nine of them reach over each cell.
class SplineGrid {
public:
    static constexpr int kReach = 9;
    using SplineWeights = std::array<double, kReach>;
    using Element = std::array<double, kReach * kReach>;

    SplineGrid(const PlanPosition& low, double cell, std::size_t columns, std::size_t rows);
    SplineGrid coarser() const;

    PlanPosition corner() const { return low_; }
    double cell() const { return cell_; }
    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return rows_; }
    std::size_t cells() const { return columns_ * rows_; }

    /// Coefficients lie in rows of this many, with two zeros around them.
    std::size_t stride() const { return columns_ + 6; }
    std::size_t length() const { return stride() * (rows_ + 6); }
    std::size_t coefficients() const { return (columns_ + 2) * (rows_ + 2); }
    std::size_t first_of(std::size_t cell) const {
        return (cell / columns_ + 2) * stride() + cell % columns_ + 2;
    }
    std::size_t number(std::size_t column, std::size_t row) const {
        return (row + 2) * stride() + column + 2;
    }

    std::size_t cell_of(const PlanPosition& position) const;
    SplineWeights values(const PlanPosition& position, std::size_t cell) const;
    /// The factors of values: the (3 j + i)-th is second[j] * first[i].
    std::array<std::array<double, 3>, 2> values_along(const PlanPosition& position,
                                                      std::size_t column, std::size_t row) const {
        return {along((position[0] - low_[0]) * inverse_cell_ - static_cast<double>(column)),
                along((position[1] - low_[1]) * inverse_cell_ - static_cast<double>(row))};
    }
    /// Of the rise along a vector, at the slope of the position.
    SplineWeights rises(const PlanPosition& position, std::size_t cell,
                        const PlanPosition& along_vector) const;
    /// Of a surface with these coefficients: bending . (its second derivatives xx, xy, yy).
    SplineWeights bends(const PlanPosition& position, std::size_t cell,
                        const std::array<double, 3>& bending) const;

private:
    static std::array<double, 3> along(double u) {
        return {0.5 * (1 - u) * (1 - u), 0.5 + u * (1 - u), 0.5 * u * u};
    }

    PlanPosition low_;
    double cell_, inverse_cell_;
    std::size_t columns_, rows_;
};

/// Adds the outer product of weights to an element.
void add_square(SplineGrid::Element& element, const SplineGrid::SplineWeights& weights,
                double strength);

/// The symmetric matrix of a grid's coefficients, 25 entries in each row; a matrix for Smoother.
class SplineStencils {
public:
    explicit SplineStencils(const SplineGrid& grid);

    const SplineGrid& grid() const { return grid_; }

    /// The sum of the cells' elements, and `least` on the diagonal.
    void assemble(std::span<const SplineGrid::Element> elements, double least, int threads);

    /// Of coefficient (column, row) with that of (column + k % 5 - 2, row + k / 5 - 2).
    double entry(std::size_t column, std::size_t row, std::size_t k) const {
        return entries_[(25 * row + k) * width_ + column];
    }

    static constexpr std::size_t kMostRows = 512;
    const WavefrontSweep& sweep() const { return sweep_; }
    /// Numbers of coefficients: a part of a row of the grid.
    std::array<std::size_t, 2> rows(std::ptrdiff_t piece) const;
    void times(std::ptrdiff_t piece, const double* x, double* out) const;

private:
    SplineGrid grid_;
    std::size_t width_, height_,
        ranges_in_row_;  // columns, rows of coefficients; pieces in each row
    Vector entries_;     // [row][k][column]
    WavefrontSweep sweep_;
};

/// A mesh in units of its mean edge, its nodes in the order of the cells of a grid of splines.
struct OrderedMesh {
    using Triangle = std::array<std::int32_t, 3>;

    SplineGrid grid;
    std::vector<std::size_t> first_in_cell;  ///< nodes of each cell of the grid, and their number
    std::vector<std::int32_t> old_number, new_number;
    std::vector<PlanPosition> nodes;
    std::vector<Triangle> triangles;
};

/// @param nodes, triangles  at least one of each, of valid indices
OrderedMesh ordered_mesh(std::span<const PlanPosition> nodes,
                         std::span<const OrderedMesh::Triangle> triangles);

}  // namespace realmodel::interpolation
