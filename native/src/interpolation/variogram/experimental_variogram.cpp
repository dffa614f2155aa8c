// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/experimental_variogram.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interpolation/data_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t points_for_far_pairs = 2000;
constexpr std::size_t points_for_near_pairs = 20'000;
constexpr std::size_t near_neighbours = 32;
constexpr double class_growth = 1.25;

/// A fixed, even part of the numbers below `count`.
std::vector<std::size_t> even_part(std::size_t count, std::size_t most) {
    const std::size_t taken = std::min(count, most);
    std::vector<std::size_t> part(taken);
    for (std::size_t i = 0; i < taken; ++i)
        part[i] = i * count / taken;
    return part;
}

/// Pairs by classes of distance whose limits grow geometrically.
class Classes {
public:
    Classes(double first_limit, double last_limit) : first_(first_limit) {
        const double growth = std::log(last_limit / first_limit) / std::log(class_growth);
        sums_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil(growth) + 1)));
    }
    double limit(std::size_t k) const { return first_ * std::pow(class_growth, k); }
    std::size_t size() const { return sums_.size(); }
    std::size_t class_of(double distance) const {
        if (distance <= first_) return 0;
        return static_cast<std::size_t>(
            std::ceil(std::log(distance / first_) / std::log(class_growth)));
    }
    void add(std::size_t k, double distance, double difference) {
        sums_[k].pairs += 1;
        sums_[k].distance += distance;
        sums_[k].square += difference * difference;
    }

    /// Neighbouring classes are joined until each has `least` pairs; the rest at the end is left
    /// out, unless it is all there is.
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
    std::vector<Sum> sums_;
};

}  // namespace

std::vector<Place> isotropic_places(const DataPoints& data, const Anisotropy& anisotropy) {
    const double azimuth = anisotropy.azimuth * std::numbers::pi / 180;
    const double stretch = std::max(anisotropy.ratio, 1 / anisotropy.ratio);
    const double s = std::sin(azimuth), c = std::cos(azimuth);
    std::vector<Place> places;
    places.reserve(data.local.size());
    for (const auto& [x, y] : data.local)
        places.push_back({s * x + c * y, stretch * (c * x - s * y)});
    return places;
}

double diagonal(std::span<const Place> places) {
    Place low = places[0], high = places[0];
    for (const Place& p : places) {
        for (int axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    return std::hypot(high[0] - low[0], high[1] - low[1]);
}

ExperimentalVariogram experimental_variogram(const DataPoints& data, const Anisotropy& anisotropy) {
    const std::size_t count = data.local.size();
    if (count < 2) return {};
    const std::vector<Place> places = isotropic_places(data, anisotropy);
    const spatial::NearestPoints tree(places);

    // Near pairs: each point with its nearest others, as far as these are surely all.
    const std::vector<std::size_t> near_part = even_part(count, points_for_near_pairs);
    const std::size_t neighbours = std::min(near_neighbours, count - 1);
    std::vector<spatial::Neighbour> found;
    std::vector<double> nearest, farthest;
    for (const std::size_t i : near_part) {
        tree.find(places[i], neighbours + 1, found);
        nearest.push_back(found[1].squared_distance);
        farthest.push_back(found.back().squared_distance);
    }
    const auto median = [](std::vector<double>& v) {
        const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
        std::nth_element(v.begin(), middle, v.end());
        return std::sqrt(*middle);
    };
    const double spacing = median(nearest);
    const double near_limit = median(farthest) / 2;
    const double far_limit = std::max(0.5 * diagonal(places), 1.5 * spacing);

    Classes classes(1.25 * spacing, far_limit);
    const bool all_pairs = count <= points_for_far_pairs;
    std::size_t near_classes = 0;
    while (!all_pairs && near_classes < classes.size() &&
           classes.limit(near_classes) <= near_limit) {
        ++near_classes;
    }
    std::vector<bool> is_centre(count, false);
    for (const std::size_t i : near_part)
        is_centre[i] = true;
    for (const std::size_t i : near_part) {
        if (near_classes == 0) break;
        tree.find(places[i], neighbours + 1, found);
        for (const spatial::Neighbour& n : found) {
            const auto j = static_cast<std::size_t>(n.point);
            if (j <= i && is_centre[j]) continue;  // the point itself, or a pair seen from there
            const double distance = std::sqrt(n.squared_distance);
            const std::size_t k = classes.class_of(distance);
            if (k >= near_classes) break;
            classes.add(k, distance, data.values[i] - data.values[j]);
        }
    }
    const std::vector<std::size_t> far_part = even_part(count, points_for_far_pairs);
    for (std::size_t a = 0; a < far_part.size(); ++a) {
        for (std::size_t b = a + 1; b < far_part.size(); ++b) {
            const std::size_t i = far_part[a], j = far_part[b];
            const double distance =
                std::hypot(places[i][0] - places[j][0], places[i][1] - places[j][1]);
            if (distance > far_limit) continue;
            const std::size_t k = classes.class_of(distance);
            if (k < near_classes || k >= classes.size()) continue;
            classes.add(k, distance, data.values[i] - data.values[j]);
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
