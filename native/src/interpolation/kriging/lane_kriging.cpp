// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/lane_kriging.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "interpolation/drift_basis.hpp"

namespace realmodel::interpolation {

LaneKriging::LaneKriging(const LinearData& data, const spatial::NearestPoints& tree,
                         const Covariance& covariance, std::size_t neighbors, bool leaves_out,
                         const LaneKernels& kernels, Drift drift)
    : data_(data),
      covariance_(covariance),
      kernels_(kernels),
      points_(neighbors),
      slopes_(2 * data.dips_at_node()),
      count_(points_ + slopes_),
      ends_(points_ + 2 * slopes_),
      block_(tree, neighbors + (leaves_out ? 1 : 0)),
      drift_(drift),
      terms_(static_cast<std::size_t>(drift_terms(drift))),
      rows_(LaneSystems::numbers(count_, terms_)),
      node_x_(ends_ * kLanes),
      node_y_(ends_ * kLanes),
      with_ends_(slopes_ > 0 ? ends_ * kLanes : 0),
      estimates_(kLanes),
      variances_(kLanes),
      well_posed_(kLanes),
      scales_(slopes_ * kLanes) {
    if (slopes_ > 0) dip_block_.emplace(data.dip_tree(), data.dips_at_node());
}

/// Whether the nodes lie close enough together.
bool LaneKriging::prepare(std::span<const PlanPosition> nodes) {
    return block_.prepare(nodes) && (!dip_block_ || dip_block_->prepare(nodes));
}

void LaneKriging::find_candidates() {
    candidates_.assign(block_.candidates().begin(), block_.candidates().end());
    point_candidates_ = candidates_.size();
    ends_of_candidates_.clear();
    for (const std::int32_t point : candidates_)
        ends_of_candidates_.push_back(data_.position(point));
    if (!dip_block_) return;
    for (const std::int32_t dip : dip_block_->candidates()) {
        for (const std::int32_t slope : {0, 1}) {
            candidates_.push_back(data_.first_of_dip(dip) + slope);
            const Difference& d = data_.difference(candidates_.back());
            ends_of_candidates_.push_back(d.to);
            ends_of_candidates_.push_back(d.from);
        }
    }
}

void LaneKriging::prepare_covariances() {
    find_candidates();
    const std::size_t ends = ends_of_candidates_.size(), count = candidates_.size();
    const std::size_t pairs = (ends * (ends - 1) / 2 + kLanes - 1) / kLanes * kLanes;
    if (pairs > pair_count_) {
        pair_count_ = pairs;
        pair_x_ = AlignedNumbers(pairs);
        pair_y_ = AlignedNumbers(pairs);
        pair_covariance_ = AlignedNumbers(pairs);
    }
    double *x = pair_x_.data(), *y = pair_y_.data();
    for (std::size_t i = 1; i < ends; ++i) {
        const PlanPosition& a = ends_of_candidates_[i];
        for (std::size_t j = 0; j < i; ++j) {
            const PlanPosition& b = ends_of_candidates_[j];
            *x++ = a[0] - b[0];
            *y++ = a[1] - b[1];
        }
    }
    const auto& structures = covariance_.structures();
    kernels_.covariances(structures.data(), structures.size(), pair_x_.data(), pair_y_.data(),
                         pair_covariance_.data(), pairs);
    table_.resize(count * count);
    const double* covariance = pair_covariance_.data();
    for (std::size_t i = 0; i < point_candidates_; ++i) {
        for (std::size_t j = 0; j < i; ++j)
            table_[i * count + j] = table_[j * count + i] = *covariance++;
        table_[i * count + i] = 1;
    }
    for (std::size_t i = point_candidates_; i < count; ++i) {
        const std::size_t to = 2 * i - point_candidates_;
        const double* const of_to = pair_covariance_.data() + LaneSystems::row(to) - to;
        const double* const of_from = of_to + to;
        const Difference& d = data_.difference(candidates_[i]);
        for (std::size_t j = 0; j < i; ++j) {
            double entry = 0;
            if (j < point_candidates_) {
                entry = d.of(of_to[j], of_from[j]);
            } else {
                const Difference& other = data_.difference(candidates_[j]);
                const std::size_t k = 2 * j - point_candidates_;
                entry =
                    d.of(other.of(of_to[k], of_to[k + 1]), other.of(of_from[k], of_from[k + 1]));
            }
            table_[i * count + j] = table_[j * count + i] = entry;
        }
        table_[i * count + i] = 1;
    }
}

/// Whether all lanes are full now.
bool LaneKriging::add(const KrigingNode& node) {
    std::int32_t chosen[kMostNeighbors];
    assert(nearest_.size() >= points_);
    std::size_t count = 0;
    for (std::size_t k = 0; count < points_; ++k) {
        if (candidates_[nearest_[k]] != node.left_out) chosen[count++] = nearest_[k];
    }
    if (dip_block_) {
        for (const std::int32_t dip : dip_block_->nearest(node.position)) {
            const std::int32_t first = static_cast<std::int32_t>(point_candidates_) + 2 * dip;
            chosen[count++] = first;
            chosen[count++] = first + 1;
        }
    }
    const std::size_t lane = filled_;
    double* rows = rows_.data() + lane;
    for (std::size_t i = 0; i < count_; ++i) {
        const double* covariances = table_.data() + chosen[i] * candidates_.size();
        for (std::size_t j = 0; j <= i; ++j, rows += kLanes)
            *rows = covariances[chosen[j]];
    }
    rows += (1 + terms_) * count_ * kLanes;
    base_[lane] = data_.points().values[candidates_[chosen[0]]];
    double *x = node_x_.data() + lane, *y = node_y_.data() + lane;
    const auto add_end = [&](const PlanPosition& end) {
        *x = node.position[0] - end[0];
        *y = node.position[1] - end[1];
        x += kLanes;
        y += kLanes;
    };
    for (std::size_t i = 0; i < count_; ++i, rows += kLanes) {
        const std::int32_t datum = candidates_[chosen[i]];
        *rows = data_.value(datum, base_[lane]);
        if (data_.is_point(datum)) {
            add_end(data_.position(datum));
            continue;
        }
        const Difference& d = data_.difference(datum);
        add_end(d.to);
        add_end(d.from);
        scales_[(i - points_) * kLanes + lane] = d.scale;
    }
    number_[lane] = node.number;
    ++filled_;
    return filled_ == kLanes;
}

/// The terms of the drift after the ones, with the node as origin and in units of the farthest
/// end's distance along an axis: all of them are 0 at the node.
void LaneKriging::set_drift(double* terms) {
    const std::size_t ends = ends_ * kLanes, count = count_ * kLanes;
    const double *x = node_x_.data(), *y = node_y_.data();
    double farthest[kLanes] = {};
    for (std::size_t i = 0; i < ends; ++i) {
        double& far = farthest[i % kLanes];
        far = std::max({far, std::abs(x[i]), std::abs(y[i])});
    }
    for (double& far : farthest)
        far = far > 0 ? 1 / far : 1;
    using AtEnd = std::array<double, 5>;
    const auto at_end = [&](std::size_t i) {
        const double u = x[i] * farthest[i % kLanes], v = y[i] * farthest[i % kLanes];
        return AtEnd{u, v, u * u, u * v, v * v};
    };
    const auto set = [&](std::size_t i, const AtEnd& monomials) {
        for (std::size_t term = 0; term + 1 < terms_; ++term)
            terms[term * count + i] = monomials[term];
    };
    for (std::size_t i = 0; i < points_ * kLanes; ++i)
        set(i, at_end(i));
    for (std::size_t s = 0; s < slopes_ * kLanes; ++s) {
        const std::size_t to = (points_ + s / kLanes * 2) * kLanes + s % kLanes;
        AtEnd difference = at_end(to);
        const AtEnd from = at_end(to + kLanes);
        for (std::size_t term = 0; term < from.size(); ++term)
            difference[term] = scales_[s] * (difference[term] - from[term]);
        set(points_ * kLanes + s, difference);
    }
}

void LaneKriging::covariances_with_nodes(double* covariances) {
    const auto& structures = covariance_.structures();
    double* const with_ends = slopes_ > 0 ? with_ends_.data() : covariances;
    kernels_.covariances(structures.data(), structures.size(), node_x_.data(), node_y_.data(),
                         with_ends, ends_ * kLanes);
    if (slopes_ == 0) return;
    std::copy_n(with_ends, points_ * kLanes, covariances);
    for (std::size_t s = 0; s < slopes_ * kLanes; ++s) {
        const std::size_t to = (points_ + s / kLanes * 2) * kLanes + s % kLanes;
        covariances[points_ * kLanes + s] = scales_[s] * (with_ends[to] - with_ends[to + kLanes]);
    }
}

void LaneKriging::solve() {
    const std::size_t n = count_;
    assert(filled_ > 0);
    double* const rows = rows_.data();
    // Empty lanes must hold a system, whatever it is: the first one again.
    for (std::size_t lane = filled_; lane < kLanes; ++lane) {
        for (std::size_t i = 0; i < LaneSystems::numbers(n, terms_); i += kLanes)
            rows[i + lane] = rows[i];
        for (std::size_t i = 0; i < ends_ * kLanes; i += kLanes) {
            node_x_.data()[i + lane] = node_x_.data()[i];
            node_y_.data()[i + lane] = node_y_.data()[i];
        }
        for (std::size_t i = 0; i < slopes_ * kLanes; i += kLanes)
            scales_[i + lane] = scales_[i];
    }
    double* const covariances = rows + LaneSystems::row(n) * kLanes;
    double* const ones = covariances + n * kLanes;
    covariances_with_nodes(covariances);
    std::fill(ones, ones + points_ * kLanes, 1.0);
    std::fill(ones + points_ * kLanes, ones + n * kLanes, 0.0);
    if (drift_ == Drift::kConstant) {
        kernels_.krige({static_cast<int>(n), rows}, estimates_.data(), variances_.data());
        return;
    }
    set_drift(ones + n * kLanes);
    kernels_.krige_about_drift({static_cast<int>(n), rows, static_cast<int>(terms_)},
                               estimates_.data(), variances_.data(), well_posed_.data());
}

}  // namespace realmodel::interpolation
