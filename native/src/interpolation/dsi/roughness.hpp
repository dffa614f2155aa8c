// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {

/// An inner edge with the two triangles at it. It adds (g . z)^2, z the heights of the four nodes,
/// to the roughness of the surface: how its slope changes across the edge. Of a linear function g .
/// z is 0.
struct Hinge {
    std::array<std::int32_t, 4> nodes;
    std::array<double, 4> g;
    PlanPosition middle;            ///< of the edge
    std::array<double, 3> bending;  ///< g . z for surfaces with the second derivatives xx, xy, yy
};

/// The hinges of a mesh; triangles may have either orientation, those without area have none. A
/// triangle with no hinge at all has one of stiffness 0, so that each triangle's corners share a
/// row.
std::vector<Hinge> hinges(std::span<const PlanPosition> nodes,
                          std::span<const std::array<std::int32_t, 3>> triangles);

/// Rows of a symmetric sparse matrix: the roughness of a mesh, and what is added to it. A matrix
/// for Smoother.
class SparseRows {
public:
    /// The matrix A of the roughness z^T A z.
    SparseRows(std::size_t nodes, std::span<const Hinge> hinges, int threads);

    std::size_t size() const { return size_; }

    /// The diagonal of the roughness alone.
    const Vector& rough_diagonal() const { return rough_diagonal_; }

    /// Adds to an entry whose row and column are corners of one triangle, or the same.
    void add(std::int32_t row, std::int32_t column, double value);
    /// The roughness alone is left.
    void remove_added();

    double diagonal(std::size_t row) const { return value_[diagonal_[row]]; }
    /// Sum of the magnitudes of a row.
    double magnitude(std::size_t row) const;

    /// Calls visit(column, value) for the entries of a row; zeros on the diagonal pad it.
    template <class Visit>
    void for_entries(std::size_t row, Visit&& visit) const {
        const std::size_t slice = row / kRowsAtOnce;
        for (std::size_t k = first_[slice] + row % kRowsAtOnce; k < first_[slice + 1];
             k += kRowsAtOnce) {
            visit(column_[k], value_[k]);
        }
    }

    /// A x of one row.
    double times(std::size_t row, const double* x) const {
        double sum = 0;
        for_entries(row, [&](std::int32_t column, double value) { sum += value * x[column]; });
        return sum;
    }

    // What Smoother needs.
    static constexpr std::size_t kMostRows = 1024;
    const WavefrontSweep& sweep() const { return sweep_; }
    std::array<std::size_t, 2> rows(std::ptrdiff_t piece) const {
        const std::size_t begin = static_cast<std::size_t>(piece) * kMostRows;
        return {begin, std::min(begin + kMostRows, size())};
    }
    void times(std::ptrdiff_t piece, const double* x, double* out) const {
        const auto [begin, end] = rows(piece);
        for (std::size_t row = begin; row < end; row += kRowsAtOnce, out += kRowsAtOnce) {
            const std::size_t slice = row / kRowsAtOnce;
            std::array<double, kRowsAtOnce> sums{};
            for (std::size_t k = first_[slice]; k < first_[slice + 1]; k += kRowsAtOnce) {
                for (std::size_t lane = 0; lane < kRowsAtOnce; ++lane)
                    sums[lane] += value_[k + lane] * x[column_[k + lane]];
            }
            std::copy_n(sums.data(), std::min(kRowsAtOnce, end - row), out);
        }
    }

private:
    struct MatrixEntry {
        std::int32_t column;
        double value;
    };
    struct Changed {
        std::size_t entry;
        double before;
    };
    using HingesOfNodes = Buckets<std::int32_t>;
    static void find_row(std::size_t row, std::span<const Hinge> hinges, const HingesOfNodes& of,
                         std::vector<MatrixEntry>& entries);
    void fill_slice(std::size_t slice, std::span<const Hinge> hinges, const HingesOfNodes& of,
                    std::vector<MatrixEntry>& entries);
    void make_sweep();

    // Rows lie in slices of a few side by side, padded to the longest, so that the processor does
    // not have to guess where each ends (SELL: Kreutzer and others 2014).
    static constexpr std::size_t kRowsAtOnce = 4;
    std::size_t size_;
    std::vector<std::size_t> first_;     // entry of each slice
    std::vector<std::size_t> diagonal_;  // entry of each row
    std::vector<std::int32_t> column_;
    Vector value_;
    Vector rough_diagonal_;
    std::vector<Changed> changed_;
    WavefrontSweep sweep_;
};

}  // namespace realmodel::interpolation
