// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/lane_kriging.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "interpolation/drift_basis.hpp"

namespace realmodel::interpolation {

LaneKriging::LaneKriging(const DataPoints& data, const spatial::NearestPoints& tree,
                         const Covariance& covariance, std::size_t neighbors, bool leaves_out,
                         const LaneKernels& kernels, Drift drift)
    : data_(data),
      covariance_(covariance),
      kernels_(kernels),
      neighbors_(neighbors),
      block_(tree, neighbors + (leaves_out ? 1 : 0)),
      drift_(drift),
      terms_(static_cast<std::size_t>(drift_terms(drift))),
      rows_(LaneSystems::numbers(neighbors, terms_)),
      node_x_(neighbors * kLanes),
      node_y_(neighbors * kLanes),
      estimates_(kLanes),
      variances_(kLanes),
      well_posed_(kLanes) {}

void LaneKriging::prepare_covariances() {
    const std::span<const std::int32_t> candidates = block_.candidates();
    const std::size_t count = candidates.size();
    const std::size_t pairs = (count * (count - 1) / 2 + kLanes - 1) / kLanes * kLanes;
    if (pairs > pair_count_) {
        pair_count_ = pairs;
        pair_x_ = AlignedNumbers(pairs);
        pair_y_ = AlignedNumbers(pairs);
        pair_covariance_ = AlignedNumbers(pairs);
    }
    double *x = pair_x_.data(), *y = pair_y_.data();
    for (std::size_t i = 1; i < count; ++i) {
        const Position& a = data_.local[candidates[i]];
        for (std::size_t j = 0; j < i; ++j) {
            const Position& b = data_.local[candidates[j]];
            *x++ = a[0] - b[0];
            *y++ = a[1] - b[1];
        }
    }
    const auto& parts = covariance_.parts();
    kernels_.covariances(parts.data(), parts.size(), pair_x_.data(), pair_y_.data(),
                         pair_covariance_.data(), pairs);
    table_.resize(count * count);
    const double* covariance = pair_covariance_.data();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < i; ++j)
            table_[i * count + j] = table_[j * count + i] = *covariance++;
        table_[i * count + i] = 1;
    }
}

/// Whether all lanes are full now.
bool LaneKriging::add(const Node& node, std::span<const std::int32_t> nearest) {
    const std::span<const std::int32_t> candidates = block_.candidates();
    const std::size_t n = neighbors_, lane = filled_;
    std::int32_t chosen[kMostNeighbors];
    assert(nearest.size() >= n);
    std::size_t count = 0;
    for (std::size_t k = 0; count < n; ++k) {
        if (candidates[nearest[k]] != node.left_out) chosen[count++] = nearest[k];
    }
    double* rows = rows_.data() + lane;
    for (std::size_t i = 0; i < n; ++i) {
        const double* covariances = table_.data() + chosen[i] * candidates.size();
        for (std::size_t j = 0; j <= i; ++j, rows += kLanes)
            *rows = covariances[chosen[j]];
    }
    rows += (1 + terms_) * n * kLanes;
    double *x = node_x_.data() + lane, *y = node_y_.data() + lane;
    for (std::size_t i = 0; i < n; ++i, rows += kLanes, x += kLanes, y += kLanes) {
        const std::int32_t point = candidates[chosen[i]];
        if (i == 0) base_[lane] = data_.values[point];
        *rows = data_.values[point] - base_[lane];
        *x = node.position[0] - data_.local[point][0];
        *y = node.position[1] - data_.local[point][1];
    }
    number_[lane] = node.number;
    ++filled_;
    return filled_ == kLanes;
}

/// The terms of the drift after the ones, with the node as origin and in units of the farthest
/// point's distance along an axis: all of them are 0 at the node.
void LaneKriging::set_drift(double* terms) {
    const std::size_t count = neighbors_ * kLanes;
    const double *x = node_x_.data(), *y = node_y_.data();
    double farthest[kLanes] = {};
    for (std::size_t i = 0; i < count; ++i) {
        double& far = farthest[i % kLanes];
        far = std::max({far, std::abs(x[i]), std::abs(y[i])});
    }
    for (double& far : farthest)
        far = far > 0 ? 1 / far : 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double u = x[i] * farthest[i % kLanes], v = y[i] * farthest[i % kLanes];
        terms[i] = u;
        terms[count + i] = v;
        if (drift_ != Drift::kQuadratic) continue;
        terms[2 * count + i] = u * u;
        terms[3 * count + i] = u * v;
        terms[4 * count + i] = v * v;
    }
}

void LaneKriging::solve() {
    const std::size_t n = neighbors_;
    assert(filled_ > 0);
    double* const rows = rows_.data();
    // Empty lanes must hold a system, whatever it is: the first one again.
    for (std::size_t lane = filled_; lane < kLanes; ++lane) {
        for (std::size_t i = 0; i < LaneSystems::numbers(n, terms_); i += kLanes)
            rows[i + lane] = rows[i];
        for (std::size_t i = 0; i < n * kLanes; i += kLanes) {
            node_x_.data()[i + lane] = node_x_.data()[i];
            node_y_.data()[i + lane] = node_y_.data()[i];
        }
    }
    double* const covariances = rows + LaneSystems::row(n) * kLanes;
    double* const ones = covariances + n * kLanes;
    const auto& parts = covariance_.parts();
    kernels_.covariances(parts.data(), parts.size(), node_x_.data(), node_y_.data(), covariances,
                         n * kLanes);
    std::fill(ones, ones + n * kLanes, 1.0);
    if (drift_ == Drift::kConstant) {
        kernels_.krige({static_cast<int>(n), rows}, estimates_.data(), variances_.data());
        return;
    }
    set_drift(ones + n * kLanes);
    kernels_.krige_about_drift({static_cast<int>(n), rows, static_cast<int>(terms_)},
                               estimates_.data(), variances_.data(), well_posed_.data());
}

}  // namespace realmodel::interpolation
