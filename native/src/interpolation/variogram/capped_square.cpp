// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/capped_square.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

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

double honest_sill(const PredictionErrors& found) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < found.errors.size(); ++i) {
        // Where neighbors nearly coincide the variance is rounding: it must not decide.
        const double variance = std::max(found.variances[i], 1e-9);
        ratios.push_back(found.errors[i] * found.errors[i] / variance);
    }
    return quantile(std::move(ratios), kWithinTwo) / 4;
}

}  // namespace realmodel::interpolation
