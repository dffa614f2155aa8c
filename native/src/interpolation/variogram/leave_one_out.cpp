// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/leave_one_out.hpp"

#include <algorithm>
#include <cstdint>

#include "interpolation/kriging/lane_kriging.hpp"
#include "interpolation/kriging/neighbor_kriging.hpp"
#include "interpolation/neighbors/nearest_of_some.hpp"
#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kChunk = 64;
static_assert(kChunk % kLanes == 0);
constexpr std::size_t kMostNeighbors = 64;
static_assert(kMostNeighbors <= LaneKriging::kMostNeighbors);
constexpr std::size_t kAskedBeyond = 8;  // times as many are looked through for those beyond

}  // namespace

LeaveOneOut::LeaveOneOut(const ManyPoints& points, std::size_t neighbors, std::size_t most,
                         double buffer, const Execution& execution)
    : neighbors_(std::min({neighbors, points.size() - 1, kMostNeighbors})),
      execution_(execution),
      left_out_(even_part(points.size(), most)) {
    const std::size_t wanted = buffer > 0 ? kAskedBeyond * neighbors_ : neighbors_;
    const std::size_t asked = std::min(wanted, points.size() - 1) + 1;
    std::vector<spatial::Neighbor> near =
        points.nearest(IsotropicSpace({}), left_out_, asked, execution);
    near = beyond(near, asked, buffer);
    const std::vector<std::int32_t> kept = points.kept(near);
    data_ = points.some(kept);
    others_.reserve(left_out_.size() * neighbors_);
    for (std::size_t k = 0; k < near.size(); ++k) {
        if (near[k].point != left_out_[k / (neighbors_ + 1)])
            others_.push_back(index_among(kept, points.size(), near[k].point));
    }
    for (std::int32_t& point : left_out_)
        point = index_among(kept, points.size(), point);
}

/// Of each point left out, and of the `asked` nearest to it: itself, and its nearest others beyond
/// a distance, or the farthest where there are too few beyond.
std::vector<spatial::Neighbor> LeaveOneOut::beyond(std::span<const spatial::Neighbor> near,
                                                   std::size_t asked, double buffer) const {
    std::vector<spatial::Neighbor> out;
    out.reserve(left_out_.size() * (neighbors_ + 1));
    for (std::size_t k = 0; k < left_out_.size(); ++k) {
        const auto own = near.subspan(k * asked, asked);
        std::size_t first = 1;
        while (first + neighbors_ < asked && own[first].squared_distance < buffer * buffer)
            ++first;
        out.push_back(own[0]);
        out.insert(out.end(), own.begin() + first, own.begin() + first + neighbors_);
    }
    return out;
}

namespace {

/// Eight systems at a time. Their covariances are computed in lanes too: the points lie apart, and
/// share none.
class PredictionLanes {
public:
    PredictionLanes(const DataPoints& data, const Covariance& covariance, std::size_t points)
        : data_(data),
          covariance_(covariance),
          kernels_(lane_kernels().front()),
          points_(points),
          differences_(LaneSystems::row(points) + points),
          rows_(LaneSystems::numbers(points)),
          x_(differences_ * kLanes),
          y_(differences_ * kLanes),
          estimates_(kLanes),
          variances_(kLanes) {}

    /// Systems of `count` points, at most `kLanes`, each with its others.
    void solve(const std::int32_t* left_out, const std::int32_t* others, std::size_t count,
               double* errors, double* variances) {
        double base[kLanes] = {};
        double* const values = rows_.data() + (differences_ + points_) * kLanes;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t system = std::min(lane, count - 1);
            const std::int32_t* of = others + system * points_;
            double *x = x_.data() + lane, *y = y_.data() + lane;
            const auto put = [&](const Position& a, const Position& b) {
                *x = a[0] - b[0];
                *y = a[1] - b[1];
                x += kLanes;
                y += kLanes;
            };
            for (std::size_t i = 0; i < points_; ++i) {
                for (std::size_t j = 0; j <= i; ++j)
                    put(position(of[i]), position(of[j]));
            }
            for (std::size_t i = 0; i < points_; ++i)
                put(position(left_out[system]), position(of[i]));
            base[lane] = value(of[0]);
            for (std::size_t i = 0; i < points_; ++i)
                values[i * kLanes + lane] = value(of[i]) - base[lane];
        }
        const auto& parts = covariance_.parts();
        double* const rows = rows_.data();
        kernels_.covariances(parts.data(), parts.size(), x_.data(), y_.data(), rows,
                             differences_ * kLanes);
        for (std::size_t i = 0; i < points_; ++i)  // whatever the nugget
            std::fill_n(rows + (LaneSystems::row(i) + i) * kLanes, kLanes, 1.0);
        std::fill_n(rows + differences_ * kLanes, points_ * kLanes, 1.0);
        kernels_.krige({static_cast<int>(points_), rows}, estimates_.data(), variances_.data());
        for (std::size_t system = 0; system < count; ++system) {
            errors[system] = base[system] + estimates_.data()[system] - value(left_out[system]);
            variances[system] = variances_.data()[system];
        }
    }

private:
    const Position& position(std::int32_t point) const { return data_.local[point]; }
    double value(std::int32_t point) const { return data_.values[point]; }

    const DataPoints& data_;
    const Covariance& covariance_;
    const LaneKernels& kernels_;
    std::size_t points_, differences_;
    AlignedNumbers rows_, x_, y_, estimates_, variances_;
};

/// Points that one thread predicts in a row, of so many neighbors. A fit calls this some hundred
/// times: below about a millisecond the threads of OpenMP would use more time waiting for the next
/// call than they save.
std::size_t points_in_chunk(std::size_t neighbors) {
    return neighbors <= 16 ? 2048 : neighbors <= 32 ? 256 : kChunk;
}
static_assert(2048 % kLanes == 0 && 256 % kLanes == 0);

}  // namespace

void LeaveOneOut::predict_in_lanes(const Covariance& covariance, PredictionErrors& out) const {
    const NodeLoop loop{
        left_out_.size(), points_in_chunk(neighbors_), {execution_.threads, nullptr}};
    loop.over_chunks([&] { return PredictionLanes(data_, covariance, neighbors_); },
                     [&](PredictionLanes& own, std::size_t begin, std::size_t end) {
                         for (std::size_t k = begin; k < end; k += kLanes) {
                             own.solve(left_out_.data() + k, others_.data() + k * neighbors_,
                                       std::min<std::size_t>(kLanes, end - k),
                                       out.errors.data() + k, out.variances.data() + k);
                         }
                     });
    if (execution_.progress != nullptr) execution_.progress->check();
}

PredictionErrors LeaveOneOut::errors(const Covariance& covariance, Drift drift) const {
    const std::size_t count = left_out_.size();
    PredictionErrors out{std::vector<double>(count), std::vector<double>(count)};
    if (drift == Drift::kConstant) {
        predict_in_lanes(covariance, out);
        return out;
    }
    struct Scratch {
        NeighborKriging kriging;
        std::vector<spatial::Neighbor> near;
    };
    const LinearData points(data_);
    const NodeLoop loop{count, kChunk, execution_, nullptr, 0, 0};
    loop.over_nodes(
        [&] {
            return Scratch{NeighborKriging(points, covariance, drift),
                           std::vector<spatial::Neighbor>(neighbors_)};
        },
        [&](Scratch& own, std::size_t k) {
            const std::int32_t point = left_out_[k];
            for (std::size_t i = 0; i < neighbors_; ++i)
                own.near[i].point = others_[k * neighbors_ + i];
            const Estimate found =
                own.kriging.at(data_.local[point], own.near, 0, execution_.progress);
            out.errors[k] = found.value - data_.values[point];
            out.variances[k] = found.variance;
        });
    return out;
}

}  // namespace realmodel::interpolation
