// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/anisotropy_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kLargestRatio = 4;
constexpr double kFirstRatios[] = {1.4, 2.2};
constexpr int kDirections = 6;
constexpr double kFirstStep = 0.25, kLastStep = 0.03;  // of the logarithm of the ratio
constexpr double kLeastSpread = 0.05;                  // across, of that along

/// The logarithm of the ratio as length, twice the azimuth as direction: continuous, also where the
/// azimuth passes 180 degrees and where there is no anisotropy.
using Vector = std::array<double, 2>;

Anisotropy anisotropy_of(const Vector& v) {
    const double length = std::min(elementary::hypot(v[0], v[1]), elementary::log(kLargestRatio));
    double azimuth = elementary::atan2(v[1], v[0]) * 90 / std::numbers::pi;
    if (azimuth < 0) azimuth += 180;
    return {elementary::exp(length), length > 0 ? azimuth : 0};
}

}  // namespace

CurveFit stretched(CurveFit fit, const Anisotropy& anisotropy) {
    fit.curve.range *= std::sqrt(anisotropy.ratio);
    return fit;
}

Anisotropy find_anisotropy(const LeaveOneOut& points, const CurveFit& fit,
                           const CappedSquare& square_of) {
    const auto square = [&](const Vector& v) {
        const Anisotropy anisotropy = anisotropy_of(v);
        const Variogram variogram = variogram_of(stretched(fit, anisotropy), anisotropy);
        return square_of(points.errors(Covariance(variogram)).errors);
    };
    Vector best{0, 0};
    double least = square(best);
    const auto attempt = [&](const Vector& v) {
        const double found = square(v);
        if (!(found < least)) return false;
        least = found;
        best = v;
        return true;
    };
    for (const double ratio : kFirstRatios) {
        for (int k = 0; k < kDirections; ++k) {
            const double angle = 2 * std::numbers::pi * k / kDirections;
            attempt({elementary::log(ratio) * elementary::cos(angle),
                     elementary::log(ratio) * elementary::sin(angle)});
        }
    }
    // Steps along the axes, shorter where none is better (Hooke and Jeeves 1961, the plain part).
    for (double step = kFirstStep; step > kLastStep;) {
        bool better = false;
        for (const Vector& side : {Vector{1, 0}, Vector{0, 1}, Vector{-1, 0}, Vector{0, -1}}) {
            const Vector v{best[0] + step * side[0], best[1] + step * side[1]};
            if (elementary::hypot(v[0], v[1]) <= elementary::log(kLargestRatio))
                better = attempt(v) || better;
        }
        if (!better) step /= 2;
    }
    return anisotropy_of(best);
}

bool spread_in_plan(const ManyPoints& points) {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    const auto count = static_cast<double>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto [px, py] = points.local(i);
        x += px / count;
        y += py / count;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto [px, py] = points.local(i);
        xx += (px - x) * (px - x);
        xy += (px - x) * (py - y);
        yy += (py - y) * (py - y);
    }
    // Eigenvalues of the matrix of second moments: squares of the spreads along and across.
    const double half = (xx + yy) / 2, apart = elementary::hypot((xx - yy) / 2, xy);
    return half - apart > kLeastSpread * kLeastSpread * (half + apart);
}

}  // namespace realmodel::interpolation
