// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {

/// The fine part of multigrid: smooths A x = b before and after a correction from coarser
/// functions, both times by the same Chebyshev polynomial of D^-1 A on the upper part of its
/// spectrum (Adams, Brezina, Hu and Tuminaro 2003), so that the whole is symmetric.
///
/// A Matrix has sweep(), of its rows in pieces; rows(piece), the first of them and one beyond the
/// last; times(piece, x, out), the products of these rows, from out[0] on; kMostRows, the
/// most rows of a piece.
class Smoother {
public:
    static constexpr std::size_t kDegree = 3;

    void resize(std::size_t count) {
        residual_.assign(count, 0.0);
        for (Vector& step : steps_)
            step.assign(count, 0.0);
    }

    /// inverse_diagonal is kept; largest: eigenvalue of D^-1 A, or above.
    void set(Vector inverse_diagonal, double largest);

    /// x from 0, and what residual it leaves.
    template <class Matrix>
    void pre_smooth(const Matrix& matrix, const Vector& right, Vector& x, int threads);
    const Vector& residual() const { return residual_; }

    /// To be set between pre_smooth() and post_smooth(): the correction from coarser functions.
    Vector& correction() { return steps_.back(); }

    /// Adds the correction, and the polynomial of what is left then.
    /// @return right . x
    template <class Matrix>
    double post_smooth(const Matrix& matrix, const Vector& right, Vector& x, int threads);

private:
    // Step k is old[k] times the one before, and fresh[k] D^-1 times the residual.
    std::array<double, kDegree> old_{}, fresh_{};
    Vector inverse_diagonal_, residual_;
    std::array<Vector, kDegree> steps_;
};

inline void Smoother::set(Vector inverse_diagonal, double largest) {
    constexpr double kShare = 0.08;  // of the spectrum is left to coarser functions
    inverse_diagonal_ = std::move(inverse_diagonal);
    const double high = largest, low = kShare * largest;
    const double theta = (high + low) / 2, delta = (high - low) / 2, sigma = theta / delta;
    double rho = 1 / sigma;
    fresh_[0] = 1 / theta;
    for (std::size_t k = 1; k < kDegree; ++k) {
        const double next = 1 / (2 * sigma - rho);
        old_[k] = next * rho;
        fresh_[k] = 2 * next / delta;
        rho = next;
    }
}

template <class Matrix>
void Smoother::pre_smooth(const Matrix& matrix, const Vector& right, Vector& x, int threads) {
    matrix.sweep().run(kDegree + 1, threads, [&](std::size_t stage, std::ptrdiff_t piece) {
        const auto [begin, end] = matrix.rows(piece);
        if (stage == 0) {
            for (std::size_t i = begin; i < end; ++i) {
                residual_[i] = right[i];
                x[i] = steps_[0][i] = fresh_[0] * inverse_diagonal_[i] * right[i];
            }
            return;
        }
        std::array<double, Matrix::kMostRows> product;
        const Vector& last = steps_[stage - 1];
        matrix.times(piece, last.data(), product.data());
        for (std::size_t i = begin; i < end; ++i)
            residual_[i] -= product[i - begin];
        if (stage == kDegree) return;
        const double old = old_[stage], fresh = fresh_[stage];
        Vector& step = steps_[stage];
        for (std::size_t i = begin; i < end; ++i) {
            step[i] = old * last[i] + fresh * inverse_diagonal_[i] * residual_[i];
            x[i] += step[i];
        }
    });
}

template <class Matrix>
double Smoother::post_smooth(const Matrix& matrix, const Vector& right, Vector& x, int threads) {
    return matrix.sweep().sum(kDegree, threads, [&](std::size_t stage, std::ptrdiff_t piece) {
        const auto [begin, end] = matrix.rows(piece);
        std::array<double, Matrix::kMostRows> product;
        const Vector& last = stage == 0 ? correction() : steps_[stage - 1];
        matrix.times(piece, last.data(), product.data());
        if (stage == 0) {
            for (std::size_t i = begin; i < end; ++i)
                x[i] += last[i];
        }
        const double old = old_[stage], fresh = fresh_[stage];
        for (std::size_t i = begin; i < end; ++i) {
            residual_[i] -= product[i - begin];
            product[i - begin] = old * last[i] + fresh * inverse_diagonal_[i] * residual_[i];
            x[i] += product[i - begin];
        }
        if (stage + 1 < kDegree) {  // a last step is not needed again
            std::copy_n(product.data(), end - begin, steps_[stage].data() + begin);
            return 0.0;
        }
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            sum += right[i] * x[i];
        return sum;
    });
}

/// An upper bound, nearly, of the eigenvalues of D^-1 A by power iteration, at most `bound`.
template <class Matrix>
double largest_eigenvalue(const Matrix& matrix, const Vector& inverse_diagonal, double bound,
                          int threads) {
    const std::size_t count = inverse_diagonal.size();
    Vector x(count), next(count, 0.0);
    std::uint32_t random = 12345;
    for (double& value : x) {
        random = random * 1664525U + 1013904223U;
        value = static_cast<double>(random) / 4294967296.0 - 0.5;
    }
    double squared = dot(x, x, threads);
    double eigenvalue = 0;
    for (int pass = 0; pass < 10; ++pass) {
        if (!(squared > 0)) return bound;
        const double scale = 1 / std::sqrt(squared);
        squared = matrix.sweep().sum(1, threads, [&](std::size_t, std::ptrdiff_t piece) {
            const auto [begin, end] = matrix.rows(piece);
            std::array<double, Matrix::kMostRows> product;
            matrix.times(piece, x.data(), product.data());
            double sum = 0;
            for (std::size_t i = begin; i < end; ++i) {
                next[i] = scale * inverse_diagonal[i] * product[i - begin];
                sum += next[i] * next[i];
            }
            return sum;
        });
        x.swap(next);
        eigenvalue = std::sqrt(squared);
    }
    return std::min(1.25 * eigenvalue, bound);
}

}  // namespace realmodel::interpolation
