// SPDX-License-Identifier: GPL-3.0-or-later
// Multigrid on grids of quadratic B-splines: the coarse part of a preconditioner. Private.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/roughness.hpp"
#include "interpolation/vectors.hpp"

namespace realmodel::interpolation {

/// Something that pulls a surface at a place: its square times `strength` is added.
struct Pull {
    Place place;
    double strength;
};

/// Uniform biquadratic B-splines on square cells over a box. Nine of them reach over each cell.
class SplineGrid {
public:
    static constexpr int reach = 9;
    using Weights = std::array<double, reach>;
    using Element = std::array<double, reach * reach>;

    SplineGrid(const Place& low, double cell, std::size_t columns, std::size_t rows);
    SplineGrid coarser() const;

    Place corner() const { return low_; }
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

    std::size_t cell_of(const Place& place) const;
    Weights values(const Place& place, std::size_t cell) const;
    /// Of a surface with these coefficients: bending . (its second derivatives xx, xy, yy).
    Weights bends(const Place& place, std::size_t cell, const std::array<double, 3>& bending) const;

private:
    Place low_;
    double cell_;
    std::size_t columns_, rows_;
};

/// Adds the outer product of weights to an element.
void add_square(SplineGrid::Element& element, const SplineGrid::Weights& weights, double strength);

/// Solves roughness and pulls approximately on the grid, by one V-cycle over ever coarser grids. A
/// symmetric positive operator, as conjugate gradients need it of a preconditioner.
class SplineLevels {
public:
    /// Throws whatever `check` throws; it is called often.
    SplineLevels(const SplineGrid& grid, std::span<const Place> nodes,
                 std::span<const Hinge> hinges, int threads, const std::function<void()>& check);

    /// To be called before solve(), and again when pulls change.
    void set_pulls(std::span<const Pull> pulls);

    const SplineGrid& grid() const { return levels_.front().grid; }

    /// The right side, of grid().length(), to be filled; then the solution after solve().
    Vector& right() { return levels_.front().right; }
    const Vector& solution() const { return levels_.front().x; }
    void solve();

private:
    struct Level {
        explicit Level(const SplineGrid& of) : grid(of) {}
        SplineGrid grid;
        Vector stencil;  // 25 for each coefficient
        Vector inverse_diagonal, right, x, residual, step;
        double largest = 1;  // eigenvalue of D^-1 A, or above
    };

    void fill_up(std::span<const Place> nodes, std::span<const Hinge> hinges);
    void restrict_elements(std::vector<SplineGrid::Element>& elements,
                           const SplineGrid& fine) const;
    void assemble(Level& level, const std::vector<SplineGrid::Element>& elements, double least);
    void factor_coarsest(double least);
    void cycle(std::size_t at);
    void smooth(Level& level, bool from_zero);
    void multiply(const Level& level, const Vector& x, Vector& out) const;

    int threads_;
    std::function<void()> check_;
    std::vector<SplineGrid::Element> rough_;  // of the finest grid
    std::vector<Level> levels_;
    Eigen::LDLT<Eigen::MatrixXd> coarsest_;
    std::vector<std::size_t> coarsest_numbers_;
};

/// Smooths A x = b by Chebyshev polynomials of D^-1 A on the upper part of its spectrum (Adams,
/// Brezina, Hu and Tuminaro 2003): `residual` holds b - A x at the start, multiply(d, out) gives A
/// d, and x grows.
template <class Multiply>
void chebyshev(Vector& x, Vector& residual, Vector& step, Vector& product,
               const Vector& inverse_diagonal, double largest, int degree, int threads,
               Multiply&& multiply) {
    constexpr double share = 0.08;  // of the spectrum is left to coarser grids
    const double high = largest, low = share * largest;
    const double theta = (high + low) / 2, delta = (high - low) / 2, sigma = theta / delta;
    double rho = 1 / sigma;
    in_pieces(x.size(), threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            step[i] = inverse_diagonal[i] * residual[i] / theta;
            x[i] += step[i];
        }
    });
    for (int k = 1; k < degree; ++k) {
        multiply(step, product);
        const double next = 1 / (2 * sigma - rho), old = next * rho, fresh = 2 * next / delta;
        rho = next;
        in_pieces(x.size(), threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                residual[i] -= product[i];
                step[i] = old * step[i] + fresh * inverse_diagonal[i] * residual[i];
                x[i] += step[i];
            }
        });
    }
}

/// An upper bound, nearly, of the eigenvalues of D^-1 A by power iteration, at most `bound`.
template <class Multiply>
double largest_eigenvalue(const Vector& inverse_diagonal, double bound, int threads,
                          Multiply&& multiply) {
    const std::size_t count = inverse_diagonal.size();
    Vector x(count), product(count, 0.0);
    std::uint32_t random = 12345;
    for (double& value : x) {
        random = random * 1664525U + 1013904223U;
        value = static_cast<double>(random) / 4294967296.0 - 0.5;
    }
    double eigenvalue = 0;
    for (int pass = 0; pass < 10; ++pass) {
        const double length = std::sqrt(dot(x, x, threads));
        if (!(length > 0)) return bound;
        for (double& value : x)
            value /= length;
        multiply(x, product);
        in_pieces(count, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                x[i] = inverse_diagonal[i] * product[i];
        });
        eigenvalue = std::sqrt(dot(x, x, threads));
    }
    return std::min(1.25 * eigenvalue, bound);
}

}  // namespace realmodel::interpolation
