// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/thin_plate.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

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
    ThinPlateSpline(const LinearData& data, double spacing) : data_(data), kernel_{spacing} {}

    /// Of the data of these numbers, a point first. It is to be solved next.
    void take(std::span<const std::int32_t> numbers) {
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
            if (!data_.is_point(numbers_[i]))
                matrix_(i, i) = data_.between(numbers_[i], numbers_[i], kernel_);
            for (Eigen::Index k = 0; k < terms; ++k) {
                matrix_(i, n + k) = basis_.orthonormal(i, k);
                matrix_(n + k, i) = matrix_(i, n + k);
            }
            right_(i) = data_.value(numbers_[i], base_);
        }
    }

    void solve(double smoothing) {
        for (std::size_t i = 0; i < numbers_.size(); ++i) {
            const auto k = static_cast<Eigen::Index>(i);
            if (data_.is_point(numbers_[i])) matrix_(k, k) = smoothing;
        }
        solver_.compute(matrix_);
        weights_ = solver_.solve(right_);
    }

    /// @param nearest  the value of the nearest point, where points lie so near each other that
    ///                 their system is singular to the last digit
    double at(const PlanPosition& position, double nearest) const {
        const auto n = static_cast<Eigen::Index>(numbers_.size());
        const DriftBasis::Coefficients terms = basis_.solve(frame_->terms(position));
        double sum = 0;
        for (Eigen::Index k = 0; k < terms.size(); ++k)
            sum += weights_(n + k) * terms(k);
        for (Eigen::Index i = 0; i < n; ++i)
            sum += weights_(i) * data_.with_height(position, numbers_[i], kernel_);
        return std::isfinite(base_ + sum) ? base_ + sum : nearest;
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
    ThinPlateSpline whole(data, spacing);
    if (all) {
        const auto order = static_cast<double>(data.size() + 3);
        require_memory(3 * order * order * sizeof(double), order - 3, "a spline through all of",
                       32);
        if (execution.progress != nullptr) execution.progress->check();
        std::vector<std::int32_t> numbers(data.size());
        std::iota(numbers.begin(), numbers.end(), 0);
        whole.take(numbers);
        whole.solve(options.smoothing);
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
                scratch.spline.take(scratch.numbers);
                scratch.spline.solve(options.smoothing);
            }
            z[i] = scratch.spline.at(node, nearest);
        });
    return z;
}

/// Points in the order of their positions, with one index of these.
struct SplinesOfSome::Index {
    explicit Index(std::span<const std::array<double, 3>> points)
        : order(points.size()), places(places_of(points)), tree(places.local) {}

    /// Of points the positions alone, which have no values yet.
    DataPoints places_of(std::span<const std::array<double, 3>> points) {
        for (std::size_t i = 0; i < points.size(); ++i)
            require_usable(points[i], "point", i);
        std::iota(order.begin(), order.end(), 0);
        std::ranges::sort(
            order, {}, [&](std::int32_t i) { return std::tuple(points[i][0], points[i][1], i); });
        std::vector<std::array<double, 3>> level;
        for (const std::int32_t i : order) {
            level.push_back({points[i][0], points[i][1], 0});
            heights.push_back(points[i][2]);
        }
        return prepare_points(level);
    }

    std::vector<std::int32_t> order;  ///< of points
    std::vector<double> heights;      ///< in this order
    DataPoints places;
    spatial::NearestPoints tree;
};

SplinesOfSome::SplinesOfSome(std::span<const std::array<double, 3>> points)
    : index_(std::make_unique<const Index>(points)) {}

SplinesOfSome::~SplinesOfSome() = default;

std::size_t SplinesOfSome::size() const {
    return index_->heights.size();
}

std::vector<double> SplinesOfSome::heights(std::span<const std::uint8_t> counts,
                                           std::span<const std::array<double, 2>> nodes,
                                           std::span<const double> smoothings,
                                           std::size_t neighbors,
                                           const Execution& execution) const {
    require_finite_nodes(nodes);
    const std::size_t size = index_->places.local.size();
    DataPoints some = index_->places;
    some.values.assign(size, 0);
    std::vector<std::int32_t> at_place(size, 0);
    for (std::size_t k = 0; k < index_->order.size(); ++k) {
        if (counts[index_->order[k]] == 0) continue;
        const std::int32_t place = some.number_of[k];
        some.values[place] += index_->heights[k];
        ++at_place[place];
    }
    spatial::PlanBox box = spatial::kNoBox;
    std::size_t count = 0;
    for (std::size_t p = 0; p < size; ++p) {
        if (at_place[p] == 0) continue;
        some.values[p] /= at_place[p];
        const auto& [x, y] = some.local[p];
        box = box.united({x, y, x, y});
        ++count;
    }
    if (count == 0) throw InputError("no_points", "there are no points to interpolate from");
    const LinearData data(some);
    std::vector<double> z(smoothings.size() * nodes.size());
    struct SomeScratch {
        ThinPlateSpline spline;
        std::vector<spatial::Neighbor> near;
        std::vector<std::int32_t> numbers;
    };
    const NodeLoop loop{nodes.size(), 64, execution, "thin plate spline"};
    loop.over_nodes(
        [&] {
            return SomeScratch{ThinPlateSpline(data, spacing_in(box, count)), {}, {}};
        },
        [&](SomeScratch& scratch, std::size_t i) {
            const PlanPosition node = some.to_local(nodes[i]);
            index_->tree.find_among(node, std::min(neighbors, count), at_place, scratch.near);
            scratch.numbers.clear();
            for (const spatial::Neighbor& n : scratch.near)
                scratch.numbers.push_back(n.point);
            scratch.spline.take(scratch.numbers);
            const double nearest = some.values[scratch.near[0].point];
            for (std::size_t s = 0; s < smoothings.size(); ++s) {
                const bool is_met = scratch.near[0].squared_distance == 0 && smoothings[s] == 0;
                if (!is_met) scratch.spline.solve(smoothings[s]);
                z[s * nodes.size() + i] = is_met ? nearest : scratch.spline.at(node, nearest);
            }
        });
    return z;
}

}  // namespace realmodel::interpolation
