// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/experimental_variogram.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interpolation/data_points.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kPointsForFarPairs = 2000;
constexpr std::size_t kPointsForNearPairs = 20'000;
constexpr std::size_t kNearNeighbors = 32;
constexpr double kClassGrowth = 1.25;

/// Pairs by classes of distance whose limits grow geometrically.
class Classes {
public:
    Classes(double first_limit, double last_limit) : first_(first_limit) {
        const double growth = elementary::log(last_limit / first_limit) / log_growth_;
        sums_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil(growth) + 1)));
    }
    double limit(std::size_t k) const { return first_ * elementary::pow(kClassGrowth, k); }
    std::size_t size() const { return sums_.size(); }
    std::size_t class_of(double distance) const {
        if (distance <= first_) return 0;
        return static_cast<std::size_t>(
            std::ceil(elementary::log(distance / first_) / log_growth_));
    }
    void add(std::size_t k, double distance, double difference) {
        sums_[k].pairs += 1;
        sums_[k].distance += distance;
        sums_[k].square += difference * difference;
    }

    /// Neighboring classes joined until each has `least` pairs; the rest at the end is left out,
    /// unless it is all there is.
    ExperimentalVariogram joined(std::int64_t least) const {
        ExperimentalVariogram out;
        Sum sum;
        for (const Sum& next : sums_) {
            sum.pairs += next.pairs;
            sum.distance += next.distance;
            sum.square += next.square;
            if (sum.pairs < least) continue;
            push(out, sum);
            sum = {};
        }
        if (out.lags.empty() && sum.pairs > 0) push(out, sum);
        return out;
    }
    std::int64_t pairs() const {
        std::int64_t all = 0;
        for (const Sum& sum : sums_)
            all += sum.pairs;
        return all;
    }

private:
    struct Sum {
        std::int64_t pairs = 0;
        double distance = 0, square = 0;
    };
    static void push(ExperimentalVariogram& out, const Sum& sum) {
        const auto pairs = static_cast<double>(sum.pairs);
        out.lags.push_back(sum.distance / pairs);
        out.gamma.push_back(sum.square / (2 * pairs));
        out.pairs.push_back(sum.pairs);
    }
    double first_;
    const double log_growth_ = elementary::log(kClassGrowth);
    std::vector<Sum> sums_;
};

double upper_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

std::vector<Position> isotropic_positions(const DataPoints& data, const Anisotropy& anisotropy) {
    const double azimuth = anisotropy.azimuth * std::numbers::pi / 180;
    const double stretch = std::max(anisotropy.ratio, 1 / anisotropy.ratio);
    const double s = elementary::sin(azimuth), c = elementary::cos(azimuth);
    std::vector<Position> positions;
    positions.reserve(data.local.size());
    for (const auto& [x, y] : data.local)
        positions.push_back({s * x + c * y, stretch * (c * x - s * y)});
    return positions;
}

double diagonal(std::span<const Position> positions) {
    const spatial::PlanBox box = spatial::box_around(positions);
    return elementary::hypot(box.width(), box.height());
}

ExperimentalVariogram experimental_variogram(const DataPoints& data, const Anisotropy& anisotropy) {
    const std::size_t count = data.local.size();
    if (count < 2) return {};
    const std::vector<Position> positions = isotropic_positions(data, anisotropy);
    const spatial::NearestPoints tree(positions);
    const std::vector<std::int32_t> near_part = even_part(count, kPointsForNearPairs);
    const std::size_t neighbors = std::min(kNearNeighbors, count - 1);
    std::vector<spatial::Neighbor> found;
    std::vector<double> nearest, farthest;
    for (const std::int32_t i : near_part) {
        tree.find(positions[i], neighbors + 1, found);
        nearest.push_back(found[1].squared_distance);
        farthest.push_back(found.back().squared_distance);
    }
    const double spacing = std::sqrt(upper_median(nearest));
    const double near_limit = std::sqrt(upper_median(farthest)) / 2;
    const double far_limit = std::max(0.5 * diagonal(positions), 1.5 * spacing);

    Classes classes(1.25 * spacing, far_limit);
    std::size_t near_classes = 0;
    if (count > kPointsForFarPairs) {
        while (near_classes < classes.size() && classes.limit(near_classes) <= near_limit)
            ++near_classes;
    }
    const auto add_pair = [&](std::size_t k, double distance, std::int32_t i, std::int32_t j) {
        classes.add(k, distance, data.values[i] - data.values[j]);
    };
    // Near pairs: each point with its nearest others, as far as these are surely all.
    std::vector<bool> in_part(count, false);
    for (const std::int32_t i : near_part)
        in_part[i] = true;
    for (const std::int32_t i : near_part) {
        if (near_classes == 0) break;
        tree.find(positions[i], neighbors + 1, found);
        for (const spatial::Neighbor& n : found) {
            if (n.point <= i && in_part[n.point]) continue;  // itself, or a pair seen from there
            const double distance = std::sqrt(n.squared_distance);
            const std::size_t k = classes.class_of(distance);
            if (k >= near_classes) break;
            add_pair(k, distance, i, n.point);
        }
    }
    const std::vector<std::int32_t> far_part = even_part(count, kPointsForFarPairs);
    for (auto i = far_part.begin(); i != far_part.end(); ++i) {
        for (auto j = i + 1; j != far_part.end(); ++j) {
            const double distance = elementary::hypot(positions[*i][0] - positions[*j][0],
                                                      positions[*i][1] - positions[*j][1]);
            if (distance > far_limit) continue;
            const std::size_t k = classes.class_of(distance);
            if (k >= near_classes && k < classes.size()) add_pair(k, distance, *i, *j);
        }
    }
    // Thirty pairs a class is what practice asks for (Journel and Huijbregts 1978); few points
    // still get a handful of classes.
    return classes.joined(std::clamp<std::int64_t>(classes.pairs() / 8, 1, 30));
}

ExperimentalVariogram experimental_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& anisotropy) {
    check_anisotropy(anisotropy);
    return experimental_variogram(prepare_points(points), anisotropy);
}

}  // namespace realmodel::interpolation
