// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/thin_plate.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/vectors.hpp"
#include "interpolation/drift_basis.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

/// r^2 log r from r^2.
double kernel(double squared) {
    return squared > 0 ? 0.5 * squared * elementary::log(squared) : 0;
}

double spacing_in(const spatial::PlanBox& box, std::size_t points) {
    const double width = box.width(), height = box.height();
    const auto count = static_cast<double>(points);
    const double spacing =
        std::max(std::sqrt(width * height / count), std::max(width, height) / count);
    return spacing > 0 ? spacing : 1;
}

double mean_spacing_of(std::span<const PlanPosition> positions) {
    return spacing_in(spatial::box_around(positions), positions.size());
}

/// A spline through some data. Keeps its memory; one for each thread.
class ThinPlateSpline {
public:
    ThinPlateSpline(const LinearData& data, double spacing, double smoothing)
        : data_(data), kernel_{spacing}, smoothing_(smoothing) {}

    /// Of the data of these numbers, a point first.
    void make(std::span<const std::int32_t> numbers) {
        numbers_.assign(numbers.begin(), numbers.end());
        positions_.clear();
        for (const std::int32_t number : numbers_)
            positions_.push_back(data_.position(number));
        frame_.emplace(positions_, Drift::kLinear);
        const auto n = static_cast<Eigen::Index>(numbers_.size());
        terms_.resize(n, drift_terms(Drift::kLinear));
        for (Eigen::Index i = 0; i < n; ++i)
            terms_.row(i) = data_.terms(numbers_[i], *frame_);
        basis_.make(terms_, terms_);
        const Eigen::Index terms = basis_.size();
        base_ = data_.value(numbers_[0], 0);
        matrix_.setZero(n + terms, n + terms);
        right_.setZero(n + terms);
        const bool has_dips = data_.dip_count() > 0;  // without them all data are points
        for (Eigen::Index i = 0; i < n; ++i) {
            for (Eigen::Index j = 0; j < i; ++j) {
                matrix_(i, j) = has_dips ? data_.between(numbers_[i], numbers_[j], kernel_)
                                         : kernel_(positions_[i], positions_[j]);
                matrix_(j, i) = matrix_(i, j);
            }
            const bool is_point = data_.is_point(numbers_[i]);
            matrix_(i, i) =
                is_point ? smoothing_ : data_.between(numbers_[i], numbers_[i], kernel_);
            for (Eigen::Index k = 0; k < terms; ++k) {
                matrix_(i, n + k) = basis_.orthonormal(i, k);
                matrix_(n + k, i) = matrix_(i, n + k);
            }
            right_(i) = data_.value(numbers_[i], base_);
        }
        solver_.compute(matrix_);
        weights_ = solver_.solve(right_);
    }

    double at(const PlanPosition& position) const {
        const auto n = static_cast<Eigen::Index>(numbers_.size());
        const DriftBasis::Coefficients terms = basis_.solve(frame_->terms(position));
        double sum = 0;
        for (Eigen::Index k = 0; k < terms.size(); ++k)
            sum += weights_(n + k) * terms(k);
        for (Eigen::Index i = 0; i < n; ++i)
            sum += weights_(i) * data_.with_height(position, numbers_[i], kernel_);
        return base_ + sum;
    }

private:
    /// Of two positions.
    struct ThinPlateKernel {
        double unit;
        double operator()(const PlanPosition& a, const PlanPosition& b) const {
            return kernel(squared_distance(a, b) / (unit * unit));
        }
    };

    const LinearData& data_;
    ThinPlateKernel kernel_;
    double smoothing_;
    double base_ = 0;
    std::vector<std::int32_t> numbers_;
    std::vector<PlanPosition> positions_;
    std::optional<DriftFrame> frame_;
    DriftBasis basis_;
    Eigen::MatrixXd terms_, matrix_;
    Eigen::VectorXd right_, weights_;
    Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

void check_options(const ThinPlateOptions& options) {
    if (!(options.smoothing >= 0) || !std::isfinite(options.smoothing)) {
        throw InputError("option", "the smoothing is negative or infinite; 0 makes points hold");
    }
    if (!(options.spacing >= 0) || !std::isfinite(options.spacing))
        throw InputError("option", "the spacing is negative or infinite");
    check_neighborhood(options.neighborhood);
}

}  // namespace

double mean_spacing(std::span<const std::array<double, 3>> points, bool are_apart) {
    if (!are_apart) return mean_spacing_of(prepare_points(points).local);
    spatial::PlanBox box = spatial::kNoBox;
    for (const auto& point : points) {
        const double x = point[0] - points[0][0], y = point[1] - points[0][1];
        box = box.united({x, y, x, y});
    }
    return spacing_in(box, points.size());
}

std::vector<double> thin_plate(std::span<const std::array<double, 3>> points,
                               std::span<const std::array<double, 2>> nodes,
                               const ThinPlateOptions& options, const Execution& execution) {
    check_options(options);
    require_finite_nodes(nodes);
    const DataPoints distinct = prepare_points(points);
    const spatial::NearestPoints tree(distinct.local);
    const Neighborhood& neighborhood = options.neighborhood;
    const double spacing = options.spacing > 0 ? options.spacing : mean_spacing_of(distinct.local);
    // In units of the spacing a slope is a difference of heights, too.
    const double scale = options.dips.baseline > 0 ? spacing / options.dips.baseline : 1;
    const LinearData data(distinct, options.dips, {scale, scale});
    const std::size_t points_used = static_cast<std::size_t>(neighborhood.neighbors);
    const bool has_all = points_used >= data.point_count() && data.uses_all_dips();
    const bool all = neighborhood.plain() && (points_used == 0 || has_all);
    ThinPlateSpline whole(data, spacing, options.smoothing);
    if (all) {
        const auto order = static_cast<double>(data.size() + 3);
        require_memory(3 * order * order * sizeof(double), order - 3, "a spline through all of",
                       32);
        if (execution.progress != nullptr) execution.progress->check();
        std::vector<std::int32_t> numbers(data.size());
        std::iota(numbers.begin(), numbers.end(), 0);
        whole.make(numbers);
    }
    std::vector<double> z(nodes.size());
    struct ThinPlateScratch {
        ThinPlateSpline spline;
        DataSearch search;
        std::vector<spatial::Neighbor> near;
        std::vector<std::int32_t> numbers;
    };
    const NodeLoop loop{nodes.size(), 256, execution, "thin plate spline"};
    loop.over_nodes(
        [&] {
            return ThinPlateScratch{whole, DataSearch(data, tree, neighborhood), {}, {}};
        },
        [&](ThinPlateScratch& scratch, std::size_t i) {
            const PlanPosition node = distinct.to_local(nodes[i]);
            if (all) {
                tree.find(node, 1, scratch.near);
            } else {
                scratch.search.find(node, scratch.near);
            }
            const double nearest = distinct.values[scratch.near[0].point];
            if (scratch.near[0].squared_distance == 0 && options.smoothing == 0) {
                z[i] = nearest;
                return;
            }
            if (!all) {
                scratch.numbers.clear();
                for (const spatial::Neighbor& n : scratch.near)
                    scratch.numbers.push_back(n.point);
                scratch.spline.make(scratch.numbers);
            }
            z[i] = scratch.spline.at(node);
            // Points so near each other that their system is singular to the last digit.
            if (!std::isfinite(z[i])) z[i] = nearest;
        });
    return z;
}

}  // namespace realmodel::interpolation
