// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/experimental_variogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/neighbors/nearest_of_some.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kPointsForFarPairs = 2000;
constexpr std::size_t kPointsForNearPairs = 20'000;
constexpr std::size_t kNearNeighbors = 32;
constexpr double kClassGrowth = 1.25;
constexpr double kNearly = 1e-9;  // of a distance, far more than rounding

/// Pairs by classes of distance whose limits grow geometrically.
class Classes {
public:
    Classes(double first_limit, double last_limit) : first_(first_limit) {
        const double growth = elementary::log(last_limit / first_limit) / log_growth_;
        sums_.resize(static_cast<std::size_t>(std::max(1.0, std::ceil(growth) + 1)));
        for (std::size_t k = 0; k < sums_.size(); ++k)
            limits_.push_back(first_ * elementary::pow(kClassGrowth, k));
    }
    double limit(std::size_t k) const { return limits_[k]; }
    std::size_t size() const { return sums_.size(); }
    std::size_t class_of(double distance) const {
        if (distance <= first_) return 0;
        // the limits tell the class without a logarithm, but for distances that nearly are one
        const auto limit = std::lower_bound(limits_.begin(), limits_.end(), distance);
        if (limit != limits_.end() && distance < (1 - kNearly) * *limit &&
            distance > (1 + kNearly) * *(limit - 1))
            return static_cast<std::size_t>(limit - limits_.begin());
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
        LagSum sum;
        for (const LagSum& next : sums_) {
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
        for (const LagSum& sum : sums_)
            all += sum.pairs;
        return all;
    }

private:
    struct LagSum {
        std::int64_t pairs = 0;
        double distance = 0, square = 0;
    };
    static void push(ExperimentalVariogram& out, const LagSum& sum) {
        const auto pairs = static_cast<double>(sum.pairs);
        out.lags.push_back(sum.distance / pairs);
        out.gamma.push_back(sum.square / (2 * pairs));
        out.pairs.push_back(sum.pairs);
    }
    double first_;
    const double log_growth_ = elementary::log(kClassGrowth);
    std::vector<double> limits_;
    std::vector<LagSum> sums_;
};

double upper_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

ExperimentalVariogram experimental_variogram(const ManyPoints& points, const Anisotropy& anisotropy,
                                             Progress* progress) {
    const std::size_t count = points.size();
    if (count < 2) return {};
    const IsotropicSpace space(anisotropy);
    const std::vector<std::int32_t> near_subset = even_subset(count, kPointsForNearPairs);
    const std::size_t row = std::min(kNearNeighbors, count - 1) + 1;
    const std::vector<spatial::Neighbor> near =
        points.nearest(space, near_subset, row, {1, progress});
    std::vector<double> nearest, farthest;
    for (std::size_t k = 0; k < near_subset.size(); ++k) {
        nearest.push_back(near[k * row + 1].squared_distance);
        farthest.push_back(near[(k + 1) * row - 1].squared_distance);
    }
    const double spacing = std::sqrt(upper_median(nearest));
    const double near_limit = std::sqrt(upper_median(farthest)) / 2;
    const double far_limit = std::max(0.5 * points.diagonal(space), 1.5 * spacing);

    Classes classes(1.25 * spacing, far_limit);
    std::size_t near_classes = 0;
    if (count > kPointsForFarPairs) {
        while (near_classes < classes.size() && classes.limit(near_classes) <= near_limit)
            ++near_classes;
    }
    const std::vector<std::int32_t> numbers = points.subset_with(near);
    const std::vector<double> values = points.some(numbers).values;
    const auto value = [&](std::int32_t i) { return values[index_among(numbers, count, i)]; };
    // Near pairs: each point with its nearest others, as far as these are surely all.
    for (std::size_t k = 0; k < near_subset.size() && near_classes > 0; ++k) {
        const std::int32_t i = near_subset[k];
        const double value_at_i = value(i);
        for (const spatial::Neighbor& n : std::span(near).subspan(k * row, row)) {
            // itself, or a pair seen from there
            if (n.point <= i && std::binary_search(near_subset.begin(), near_subset.end(), n.point))
                continue;
            const double distance = std::sqrt(n.squared_distance);
            const std::size_t at = classes.class_of(distance);
            if (at >= near_classes) break;
            classes.add(at, distance, value_at_i - value(n.point));
        }
    }
    const std::vector<std::int32_t> far_subset = even_subset(count, kPointsForFarPairs);
    const DataPoints far = points.some(far_subset);
    std::vector<PlanPosition> places;
    for (const PlanPosition& local : far.local)
        places.push_back(space(local));
    const double farthest_square = (1 + kNearly) * far_limit * far_limit;
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t j = i + 1; j < places.size(); ++j) {
            const double x = places[i][0] - places[j][0], y = places[i][1] - places[j][1];
            if (x * x + y * y > farthest_square) continue;
            const double distance = elementary::hypot(x, y);
            if (distance > far_limit) continue;
            const std::size_t at = classes.class_of(distance);
            if (at >= near_classes && at < classes.size())
                classes.add(at, distance, far.values[i] - far.values[j]);
        }
    }
    // Thirty pairs a class is what practice asks for (Journel and Huijbregts 1978); few points
    // still get a handful of classes.
    return classes.joined(std::clamp<std::int64_t>(classes.pairs() / 8, 1, 30));
}

ExperimentalVariogram experimental_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& anisotropy) {
    check_anisotropy(anisotropy);
    return experimental_variogram(ManyPoints(points), anisotropy);
}

namespace {

constexpr int kRangesTried = 48;

/// Weighted sums of 1, f, f^2, gamma and f gamma.
struct Sums {
    double w1 = 0, wf = 0, wff = 0, wg = 0, wfg = 0;

    Sums(const ExperimentalVariogram& e, const VariogramCurve& curve) {
        for (std::size_t i = 0; i < e.lags.size(); ++i) {
            const double weight = static_cast<double>(e.pairs[i]) / (e.lags[i] * e.lags[i]);
            const double f = curve(e.lags[i]);
            w1 += weight;
            wf += weight * f;
            wff += weight * f * f;
            wg += weight * e.gamma[i];
            wfg += weight * f * e.gamma[i];
        }
    }
};

void measure(const ExperimentalVariogram& e, CurveFit& fit) {
    fit.misfit = 0;
    for (std::size_t i = 0; i < e.lags.size(); ++i) {
        const double weight = static_cast<double>(e.pairs[i]) / (e.lags[i] * e.lags[i]);
        const double f = fit.curve(e.lags[i]);
        const double difference = e.gamma[i] - fit.nugget - fit.partial_sill * f;
        fit.misfit += weight * difference * difference;
    }
}

/// Both not negative: a linear problem.
CurveFit fit_for_range(const ExperimentalVariogram& e, VariogramModel model, double range,
                       bool with_nugget) {
    CurveFit fit;
    fit.curve.model = model;
    fit.curve.range = range;
    const Sums s(e, fit.curve);
    const double determinant = s.w1 * s.wff - s.wf * s.wf;
    fit.nugget = with_nugget && determinant > 1e-12 * s.w1 * s.wff
                     ? (s.wff * s.wg - s.wf * s.wfg) / determinant
                     : 0;
    fit.nugget = std::max(fit.nugget, 0.0);
    fit.partial_sill = s.wff > 0 ? (s.wfg - fit.nugget * s.wf) / s.wff : 0;
    if (fit.partial_sill < 0) {
        fit.partial_sill = 0;
        fit.nugget = with_nugget ? s.wg / s.w1 : 0;
    }
    measure(e, fit);
    return fit;
}

}  // namespace

CurveFit fit_sill(const ExperimentalVariogram& e, const VariogramCurve& curve, double nugget) {
    const Sums s(e, curve);
    CurveFit fit;
    fit.curve = curve;
    fit.nugget = nugget;
    fit.partial_sill = s.wff > 0 ? std::max((s.wfg - nugget * s.wf) / s.wff, 0.0) : 0;
    measure(e, fit);
    return fit;
}

/// The best range: tried on a geometric scale, then narrowed by golden sections.
CurveFit fit_curve(const ExperimentalVariogram& e, VariogramModel model, bool with_nugget) {
    const double shortest = 0.5 * e.lags.front(), longest = 4 * e.lags.back();
    const double step = elementary::pow(longest / shortest, 1.0 / kRangesTried);
    const auto at = [&](double range) { return fit_for_range(e, model, range, with_nugget); };
    CurveFit best;
    for (int i = 0; i <= kRangesTried; ++i) {
        const CurveFit fit = at(shortest * elementary::pow(step, i));
        if (fit.misfit < best.misfit) best = fit;
    }
    constexpr double kGolden = 0.6180339887498949;
    double low = best.curve.range / step, high = std::min(best.curve.range * step, longest);
    for (int i = 0; i < 40; ++i) {
        const double span = kGolden * (high - low);
        const CurveFit a = at(high - span), b = at(low + span);
        if (a.misfit < b.misfit) {
            high = b.curve.range;
        } else {
            low = a.curve.range;
        }
        for (const CurveFit& fit : {a, b}) {
            if (fit.misfit < best.misfit) best = fit;
        }
    }
    return best;
}

Variogram variogram_of(const CurveFit& fit, const Anisotropy& anisotropy) {
    const VariogramCurve& curve = fit.curve;
    Variogram out{curve.model, curve.range, fit.sill(), fit.nugget, anisotropy, {}};
    if (curve.rough_share > 0) {
        out.further.push_back({curve.rougher, curve.range * curve.rough_range,
                               curve.rough_share * fit.partial_sill, anisotropy});
    }
    return out;
}

void multiply_sills(Variogram& variogram, double factor) {
    variogram.sill *= factor;
    variogram.nugget *= factor;
    for (NestedStructure& nested : variogram.further)
        nested.sill *= factor;
}

}  // namespace realmodel::interpolation
