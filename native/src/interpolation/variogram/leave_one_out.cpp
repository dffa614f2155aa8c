// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/leave_one_out.hpp"

#include <algorithm>
#include <cstdint>

#include "interpolation/kriging/drift_kriging.hpp"
#include "interpolation/kriging/lane_kriging.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t chunk = 64;  // a multiple of `lanes`
constexpr std::size_t most_neighbours = 64;
static_assert(most_neighbours <= LaneKriging::most_neighbours);

}  // namespace

LeftOutPoints::LeftOutPoints(const DataPoints& data, std::size_t neighbours, std::size_t most,
                             int threads, Progress* progress)
    : data_(data),
      neighbours_(std::min({neighbours, data.local.size() - 1, most_neighbours})),
      threads_(threads),
      progress_(progress) {
    const std::size_t count = data.local.size(), taken = std::min(count, most);
    for (std::size_t k = 0; k < taken; ++k)
        left_out_.push_back(static_cast<std::int32_t>(k * count / taken));
    others_.resize(taken * neighbours_);
    const spatial::NearestPoints tree(data.local);
    for_chunks(taken, chunk, threads, nullptr, 0, "", [&](const StopSign&) {
        return [&, found = std::vector<spatial::Neighbour>()](std::size_t begin,
                                                              std::size_t end) mutable {
            for (std::size_t k = begin; k < end; ++k) {
                const std::int32_t point = left_out_[k];
                tree.find(data.local[static_cast<std::size_t>(point)], neighbours_ + 1, found);
                std::int32_t* other = others_.data() + k * neighbours_;
                for (const spatial::Neighbour& neighbour : found) {
                    if (neighbour.point != point) *other++ = neighbour.point;
                }
            }
        };
    });
}

namespace {

/// Eight systems at a time, their covariances reckoned in lanes too: the points lie apart, and
/// share none.
class LeftOutLanes {
public:
    LeftOutLanes(const DataPoints& data, const Covariance& covariance, std::size_t points)
        : data_(data),
          covariance_(covariance),
          kernels_(lane_kernels().front()),
          points_(points),
          differences_(LaneSystems::row(points) + points),
          rows_(LaneSystems::numbers(points)),
          x_(differences_ * lanes),
          y_(differences_ * lanes),
          estimates_(lanes),
          variances_(lanes) {}

    /// Systems of `count` points, at most `lanes`, each with its others.
    void solve(const std::int32_t* left_out, const std::int32_t* others, std::size_t count,
               double* errors, double* variances) {
        double base[lanes] = {};
        double* const values = rows_.data() + (differences_ + points_) * lanes;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t system = std::min(lane, count - 1);
            const std::int32_t* of = others + system * points_;
            double *x = x_.data() + lane, *y = y_.data() + lane;
            const auto put = [&](const Place& a, const Place& b) {
                *x = a[0] - b[0];
                *y = a[1] - b[1];
                x += lanes;
                y += lanes;
            };
            for (std::size_t i = 0; i < points_; ++i) {
                for (std::size_t j = 0; j <= i; ++j)
                    put(place(of[i]), place(of[j]));
            }
            for (std::size_t i = 0; i < points_; ++i)
                put(place(left_out[system]), place(of[i]));
            base[lane] = value(of[0]);
            for (std::size_t i = 0; i < points_; ++i)
                values[i * lanes + lane] = value(of[i]) - base[lane];
        }
        const auto& parts = covariance_.parts();
        double* const rows = rows_.data();
        kernels_.covariances(parts.data(), parts.size(), x_.data(), y_.data(), rows,
                             differences_ * lanes);
        for (std::size_t i = 0; i < points_; ++i)  // whatever the nugget
            std::fill_n(rows + (LaneSystems::row(i) + i) * lanes, lanes, 1.0);
        std::fill_n(rows + differences_ * lanes, points_ * lanes, 1.0);
        kernels_.krige({static_cast<int>(points_), rows}, estimates_.data(), variances_.data());
        for (std::size_t system = 0; system < count; ++system) {
            errors[system] = base[system] + estimates_.data()[system] - value(left_out[system]);
            variances[system] = variances_.data()[system];
        }
    }

private:
    const Place& place(std::int32_t point) const {
        return data_.local[static_cast<std::size_t>(point)];
    }
    double value(std::int32_t point) const { return data_.values[static_cast<std::size_t>(point)]; }

    const DataPoints& data_;
    const Covariance& covariance_;
    const LaneKernels& kernels_;
    std::size_t points_, differences_;
    AlignedNumbers rows_, x_, y_, estimates_, variances_;
};

}  // namespace

LeftOutErrors LeftOutPoints::told_by(const Covariance& covariance) const {
    const std::size_t count = left_out_.size();
    LeftOutErrors out{std::vector<double>(count), std::vector<double>(count)};
    for_chunks(count, chunk, threads_, nullptr, 0, "", [&](const StopSign&) {
        return [&, systems = LeftOutLanes(data_, covariance, neighbours_)](
                   std::size_t begin, std::size_t end) mutable {
            for (std::size_t k = begin; k < end; k += lanes) {
                systems.solve(left_out_.data() + k, others_.data() + k * neighbours_,
                              std::min<std::size_t>(lanes, end - k), out.errors.data() + k,
                              out.variances.data() + k);
            }
        };
    });
    if (progress_ != nullptr) progress_->check();
    return out;
}

LeftOutErrors LeftOutPoints::told_by(const Covariance& covariance, Drift drift) const {
    if (drift == Drift::constant) return told_by(covariance);
    const std::size_t count = left_out_.size();
    LeftOutErrors out{std::vector<double>(count), std::vector<double>(count)};
    for_chunks(count, chunk, threads_, progress_, 0, "fitting the variogram",
               [&](const StopSign& stop) {
                   return [&, kriging = DriftKriging(data_, covariance, drift),
                           near = std::vector<spatial::Neighbour>(neighbours_)](
                              std::size_t begin, std::size_t end) mutable {
                       for (std::size_t k = begin; k < end && !stop(); ++k) {
                           const auto point = static_cast<std::size_t>(left_out_[k]);
                           for (std::size_t i = 0; i < neighbours_; ++i)
                               near[i].point = others_[k * neighbours_ + i];
                           const Estimate told = kriging.at(data_.local[point], near, stop);
                           out.errors[k] = told.value - data_.values[point];
                           out.variances[k] = told.variance;
                       }
                   };
               });
    return out;
}

}  // namespace realmodel::interpolation
