// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/leave_one_out.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "interpolation/kriging/lane_kernels.hpp"
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
      left_out_(even_subset(points.size(), most)) {
    const std::size_t wanted = buffer > 0 ? kAskedBeyond * neighbors_ : neighbors_;
    const std::size_t asked = std::min(wanted, points.size() - 1) + 1;
    std::vector<spatial::Neighbor> near =
        points.nearest(IsotropicSpace({}), left_out_, asked, execution);
    near = beyond(near, asked, buffer);
    const std::vector<std::int32_t> numbers = points.subset_with(near);
    data_ = points.some(numbers);
    others_.reserve(left_out_.size() * neighbors_);
    for (std::size_t k = 0; k < near.size(); ++k) {
        if (near[k].point != left_out_[k / (neighbors_ + 1)])
            others_.push_back(index_among(numbers, points.size(), near[k].point));
    }
    for (std::int32_t& point : left_out_)
        point = index_among(numbers, points.size(), point);
}

/// Of each point left out, and of the `asked` nearest to it: itself, and its nearest others beyond
/// a distance, or the farthest where there are too few beyond.
std::vector<spatial::Neighbor> LeaveOneOut::beyond(std::span<const spatial::Neighbor> near,
                                                   std::size_t asked, double buffer) const {
    std::vector<spatial::Neighbor> out;
    out.reserve(left_out_.size() * (neighbors_ + 1));
    for (std::size_t k = 0; k < left_out_.size(); ++k) {
        const auto nearest = near.subspan(k * asked, asked);
        std::size_t first = 1;
        while (first + neighbors_ < asked && nearest[first].squared_distance < buffer * buffer)
            ++first;
        out.push_back(nearest[0]);
        out.insert(out.end(), nearest.begin() + first, nearest.begin() + first + neighbors_);
    }
    return out;
}

namespace {

/// Eight systems at a time. Their covariances are computed in lanes too: the points lie apart, and
/// share none.
class PredictionLanes {
public:
    /// @param alike  as LeaveOneOut::errors takes them
    PredictionLanes(const DataPoints& data, std::span<const Covariance> alike, std::size_t points)
        : data_(data),
          alike_(alike),
          kernels_(lane_kernels().front()),
          points_(points),
          differences_(LaneSystems::row(points) + points),
          rows_(LaneSystems::numbers(points)),
          data_x_((points + 1) * kLanes),
          data_y_((points + 1) * kLanes),
          x_(differences_ * kLanes),
          y_(differences_ * kLanes),
          estimates_(kLanes),
          variances_(kLanes) {
        for (CovarianceStructure structure : alike_.front().structures()) {
            structure.share = 1;
            structures_.push_back(structure);
            of_structures_.emplace_back(differences_ * kLanes);
        }
    }

    /// Systems of points, at most `kLanes`, each with its others.
    /// @param first  the number of the first of them in `out`, which has one of each covariance
    void solve(std::span<const std::int32_t> left_out, const std::int32_t* others,
               std::size_t first, std::span<PredictionErrors> out) {
        gather(left_out, others);
        for (std::size_t k = 0; k < structures_.size(); ++k) {
            kernels_.covariances(&structures_[k], 1, x_.data(), y_.data(), of_structures_[k].data(),
                                 differences_ * kLanes);
        }
        for (std::size_t which = 0; which < alike_.size(); ++which) {
            fill_rows(alike_[which]);
            kernels_.krige({static_cast<int>(points_), rows_.data()}, estimates_.data(),
                           variances_.data());
            for (std::size_t system = 0; system < left_out.size(); ++system) {
                out[which].errors[first + system] =
                    base_[system] + estimates_.data()[system] - value(left_out[system]);
                out[which].variances[first + system] = variances_.data()[system];
            }
        }
    }

private:
    void gather(std::span<const std::int32_t> left_out, const std::int32_t* others) {
        values_.resize(points_ * kLanes);
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t system = std::min(lane, left_out.size() - 1);
            const std::int32_t* of = others + system * points_;
            const auto put = [&](std::size_t at, const PlanPosition& position) {
                data_x_.data()[at * kLanes + lane] = position[0];
                data_y_.data()[at * kLanes + lane] = position[1];
            };
            base_[lane] = value(of[0]);
            for (std::size_t i = 0; i < points_; ++i) {
                put(i, data_.local[of[i]]);
                values_[i * kLanes + lane] = value(of[i]) - base_[lane];
            }
            put(points_, data_.local[left_out[system]]);
        }
        kernels_.differences(data_x_.data(), points_, x_.data());
        kernels_.differences(data_y_.data(), points_, y_.data());
    }

    void fill_rows(const Covariance& covariance) {
        double* const rows = rows_.data();
        for (std::size_t k = 0; k < structures_.size(); ++k)
            kernels_.add_scaled(covariance.structures()[k].share, of_structures_[k].data(), k == 0,
                                rows, differences_ * kLanes);
        for (std::size_t i = 0; i < points_; ++i)  // whatever the nugget
            std::fill_n(rows + (LaneSystems::row(i) + i) * kLanes, kLanes, 1.0);
        std::fill_n(rows + differences_ * kLanes, points_ * kLanes, 1.0);
        std::copy(values_.begin(), values_.end(), rows + (differences_ + points_) * kLanes);
    }

    double value(std::int32_t point) const { return data_.values[point]; }

    const DataPoints& data_;
    std::span<const Covariance> alike_;
    const LaneKernels& kernels_;
    std::size_t points_, differences_;
    std::vector<CovarianceStructure> structures_;  ///< with the share 1
    std::vector<AlignedNumbers> of_structures_;
    AlignedNumbers rows_, data_x_, data_y_, x_, y_, estimates_, variances_;
    std::vector<double> values_;  ///< of the points, less those of the nearest
    double base_[kLanes] = {};    ///< the values of the nearest
};

/// Points that one thread predicts in a row, of so many neighbors. A fit calls this some hundred
/// times: below about a millisecond the threads of OpenMP would use more time waiting for the next
/// call than they save.
std::size_t points_in_chunk(std::size_t neighbors) {
    return neighbors <= 16 ? 768 : neighbors <= 32 ? 256 : kChunk;
}
static_assert(768 % kLanes == 0 && 256 % kLanes == 0);

}  // namespace

std::vector<PredictionErrors> LeaveOneOut::errors(std::span<const Covariance> alike) const {
    const std::size_t all = left_out_.size();
    std::vector<PredictionErrors> out(alike.size(),
                                      {std::vector<double>(all), std::vector<double>(all)});
    if (alike.empty()) return out;
    const NodeLoop loop{all, points_in_chunk(neighbors_), {execution_.threads, nullptr}};
    loop.over_chunks([&] { return PredictionLanes(data_, alike, neighbors_); },
                     [&](PredictionLanes& lanes, std::size_t begin, std::size_t end) {
                         for (std::size_t k = begin; k < end; k += kLanes) {
                             const std::size_t count = std::min<std::size_t>(kLanes, end - k);
                             lanes.solve(std::span(left_out_).subspan(k, count),
                                         others_.data() + k * neighbors_, k, out);
                         }
                     });
    if (execution_.progress != nullptr) execution_.progress->check();
    return out;
}

PredictionErrors LeaveOneOut::errors(const Covariance& covariance, Drift drift) const {
    if (drift == Drift::kConstant) return std::move(errors({&covariance, 1}).front());
    const std::size_t count = left_out_.size();
    PredictionErrors out{std::vector<double>(count), std::vector<double>(count)};
    struct LeaveOneOutScratch {
        NeighborKriging kriging;
        std::vector<spatial::Neighbor> near;
    };
    const LinearData points(data_);
    const NodeLoop loop{count, kChunk, execution_, nullptr, 0, 0};
    loop.over_nodes(
        [&] {
            return LeaveOneOutScratch{NeighborKriging(points, covariance, drift),
                                      std::vector<spatial::Neighbor>(neighbors_)};
        },
        [&](LeaveOneOutScratch& scratch, std::size_t k) {
            const std::int32_t point = left_out_[k];
            for (std::size_t i = 0; i < neighbors_; ++i)
                scratch.near[i].point = others_[k * neighbors_ + i];
            const Estimate estimate =
                scratch.kriging.at(data_.local[point], scratch.near, 0, execution_.progress);
            out.errors[k] = estimate.value - data_.values[point];
            out.variances[k] = estimate.variance;
        });
    return out;
}

namespace {

constexpr double kOutlying = 20;      // deviations: larger errors count as this one
constexpr double kWithinTwo = 0.95;   // share of errors within two deviations where they are honest
constexpr double kSurely = 2;         // standard errors of a mean difference of squares
constexpr double kWorthwhile = 0.03;  // of the mean square: less is not worth another variogram

}  // namespace

double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

CappedSquare::CappedSquare(std::span<const double> errors) {
    std::vector<double> sizes;
    double squares = 0;
    for (const double error : errors) {
        sizes.push_back(std::abs(error));
        squares += error * error;
    }
    const double deviation = 1.4826 * quantile(std::move(sizes), 0.5);
    const double limit =
        std::max(kOutlying * deviation, std::sqrt(squares / static_cast<double>(errors.size())));
    most_ = limit * limit;
}

double CappedSquare::operator()(std::span<const double> errors) const {
    double sum = 0;
    for (const double error : errors)
        sum += std::min(error * error, most_);
    return sum / static_cast<double>(errors.size());
}

bool CappedSquare::surely_less(std::span<const double> errors,
                               std::span<const double> others) const {
    const auto count = static_cast<double>(errors.size());
    double all = 0, sum = 0, squares = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double other = std::min(others[i] * others[i], most_);
        const double less = other - std::min(errors[i] * errors[i], most_);
        all += other;
        sum += less;
        squares += less * less;
    }
    const double mean = sum / count;
    const double deviation = std::sqrt(std::max(squares / count - mean * mean, 0.0) / count);
    return mean > kSurely * deviation && sum > kWorthwhile * all;
}

double honest_sill(const PredictionErrors& predictions) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < predictions.errors.size(); ++i) {
        // Where neighbors nearly coincide the variance is rounding: it must not decide.
        const double variance = std::max(predictions.variances[i], 1e-9);
        ratios.push_back(predictions.errors[i] * predictions.errors[i] / variance);
    }
    return quantile(std::move(ratios), kWithinTwo) / 4;
}

}  // namespace realmodel::interpolation
