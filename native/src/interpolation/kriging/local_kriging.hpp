// SPDX-License-Identifier: GPL-3.0-or-later
// Ordinary kriging from a few points. Private.
#pragma once

#include <span>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// Solves one small system for each place. Keeps its memory between places; one for each thread.
class LocalKriging {
public:
    LocalKriging(const DataPoints& data, const Covariance& covariance)
        : data_(data), covariance_(covariance) {}

    /// Estimates the value at `place` (local coordinates) from neighbours, nearest first, none of
    /// which is at the place itself. `stop()` is asked now and then where there are many; the
    /// result means nothing once it has said yes.
    template <class Stop>
    Estimate at(const Place& place, std::span<const spatial::Neighbour> neighbours, Stop&& stop);

private:
    const DataPoints& data_;
    Covariance covariance_;
    std::vector<Place> places_;
    std::vector<double> matrix_;
};

template <class Stop>
Estimate LocalKriging::at(const Place& place, std::span<const spatial::Neighbour> neighbours,
                          Stop&& stop) {
    const std::size_t n = neighbours.size();
    const std::size_t rows = n + 3;
    places_.resize(n);
    matrix_.resize(n * rows);
    const double base = data_.values[neighbours[0].point];
    for (std::size_t k = 0; k < n; ++k)
        places_[k] = data_.local[neighbours[k].point];

    // Columns of the lower triangle of C, and below it the rows c^T, 1^T and (values - base)^T:
    // elimination turns them into u^T, s^T and t^T.
    for (std::size_t k = 0; k < n; ++k) {
        double* column = matrix_.data() + k * rows;
        column[k] = 1;
        for (std::size_t i = k + 1; i < n; ++i)
            column[i] = covariance_(places_[i], places_[k]);
        column[n] = covariance_(place, places_[k]);
        column[n + 1] = 1;
        column[n + 2] = data_.values[neighbours[k].point] - base;
    }
    double uu = 0, us = 0, ut = 0, ss = 0, st = 0;
    for (std::size_t k = 0; k < n; ++k) {
        if (k % 64 == 63 && stop()) return {};
        double* column = matrix_.data() + k * rows;
        // What the nearer points leave open of this one; nothing: it is passed over.
        if (column[k] < redundant_variance) continue;
        const double scale = 1 / std::sqrt(column[k]);
        for (std::size_t i = k + 1; i < rows; ++i)
            column[i] *= scale;
        for (std::size_t j = k + 1; j < n; ++j) {
            double* other = matrix_.data() + j * rows;
            const double factor = column[j];
#pragma omp simd
            for (std::size_t i = j; i < rows; ++i)
                other[i] -= factor * column[i];
        }
        const double u = column[n], s = column[n + 1], t = column[n + 2];
        uu += u * u;
        us += u * s;
        ut += u * t;
        ss += s * s;
        st += s * t;
    }
    return ordinary_kriging(base, uu, us, ut, ss, st);
}

}  // namespace realmodel::interpolation
