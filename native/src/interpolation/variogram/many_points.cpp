// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/many_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/algorithms.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/interpolation/convex_hull.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kPointsOfDrift = 20'000;

}  // namespace

IsotropicSpace::IsotropicSpace(const Anisotropy& anisotropy) {
    const double azimuth = anisotropy.azimuth * std::numbers::pi / 180;
    stretch_ = std::max(anisotropy.ratio, 1 / anisotropy.ratio);
    sin_ = elementary::sin(azimuth);
    cos_ = elementary::cos(azimuth);
}

ManyPoints::ManyPoints(std::span<const std::array<double, 3>> points, bool are_apart,
                       std::size_t most)
    : points_(points), most_(most) {
    require_countable(points.size(), "points");
    if (are_apart) return;
    const DataPoints data = prepare_points(points);
    if (data.local.size() == points.size()) return;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (static_cast<std::size_t>(data.number_of[i]) == distinct_.size())
            distinct_.push_back(points[i]);
    }
    points_ = distinct_;
}

double ManyPoints::value(std::size_t i) const {
    if (!trend_) return points_[i][2];
    const DriftBasis::Coefficients row = trend_->basis.solve(trend_->frame.terms(local(i)));
    return points_[i][2] - points_[0][2] - row.dot(trend_->coefficients);
}

void ManyPoints::take_drift_out(Drift drift) {
    const DataPoints data = some(even_subset(size(), kPointsOfDrift));
    DriftFrame frame(data.local, drift);
    const Eigen::MatrixXd terms = frame.terms(std::span<const PlanPosition>(data.local));
    DriftBasis basis;
    basis.make(terms, terms);
    Eigen::VectorXd z(terms.rows());
    for (Eigen::Index i = 0; i < z.size(); ++i)
        z(i) = data.values[i] - data.values[0];
    DriftBasis::Coefficients coefficients = basis.project(z);
    coefficients += basis.project(z - basis.expand(coefficients));
    trend_ = Trend{frame, basis, coefficients};
}

std::vector<spatial::Neighbor> ManyPoints::nearest(const IsotropicSpace& space,
                                                   std::span<const std::int32_t> asked,
                                                   std::size_t count,
                                                   const Execution& execution) const {
    const DistinctPoints positions{size(), [&](std::size_t i) { return space(local(i)); }};
    return nearest_of_some(positions, asked, count, execution, most_);
}

double ManyPoints::diagonal(const IsotropicSpace& space) const {
    spatial::PlanBox box = spatial::kNoBox;
    for (std::size_t i = 0; i < size(); ++i) {
        const auto [x, y] = space(local(i));
        box = box.united({x, y, x, y});
    }
    return elementary::hypot(box.width(), box.height());
}

double ManyPoints::largest_value() const {
    double largest = 0;
    for (const auto& point : points_)
        largest = std::max(largest, std::abs(point[2]));
    return largest;
}

std::vector<std::int32_t> ManyPoints::subset_with(std::span<const spatial::Neighbor> near) const {
    std::vector<std::int32_t> numbers;
    if (size() <= most_) {
        numbers.resize(size());
        std::iota(numbers.begin(), numbers.end(), 0);
        return numbers;
    }
    numbers.reserve(near.size());
    for (const spatial::Neighbor& neighbor : near)
        numbers.push_back(neighbor.point);
    sort_unique(numbers);
    return numbers;
}

DataPoints ManyPoints::some(std::span<const std::int32_t> numbers) const {
    DataPoints out;
    out.origin = {points_[0][0], points_[0][1]};
    out.local.reserve(numbers.size());
    out.values.reserve(numbers.size());
    for (const std::int32_t number : numbers) {
        out.local.push_back(local(static_cast<std::size_t>(number)));
        out.values.push_back(value(static_cast<std::size_t>(number)));
    }
    return out;
}

std::int32_t index_among(std::span<const std::int32_t> numbers, std::size_t size,
                         std::int32_t number) {
    if (numbers.size() == size) return number;
    return static_cast<std::int32_t>(std::lower_bound(numbers.begin(), numbers.end(), number) -
                                     numbers.begin());
}

namespace {

constexpr std::size_t kAsked = 4000;  // an even subset shows it
constexpr double kClustered = 0.5;    // of the distance that is expected of random points

double area_of_hull(const ManyPoints& points) {
    std::vector<PlanPosition> positions;
    for (const std::int32_t point : even_subset(points.size(), kMostInMemory))
        positions.push_back(points.local(static_cast<std::size_t>(point)));
    const std::vector<std::int32_t> border = hull_border(positions);
    double twice = 0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const PlanPosition& a = positions[border[i]];
        const PlanPosition& b = positions[border[(i + 1) % border.size()]];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return twice / 2;
}

}  // namespace

double buffer_of_clusters(const ManyPoints& points, const Execution& execution) {
    if (points.size() < 3) return 0;
    const std::vector<std::int32_t> asked = even_subset(points.size(), kAsked);
    const std::vector<spatial::Neighbor> near =
        points.nearest(IsotropicSpace({}), asked, 2, execution);
    double sum = 0;
    for (std::size_t k = 1; k < near.size(); k += 2)
        sum += std::sqrt(near[k].squared_distance);
    const double mean = sum / static_cast<double>(asked.size());
    const double spacing = std::sqrt(area_of_hull(points) / static_cast<double>(points.size()));
    return mean < kClustered * spacing / 2 ? 2 * spacing : 0;
}

}  // namespace realmodel::interpolation
