// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/weighted_fit.hpp"

#include <algorithm>

#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

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
    for (NestedStructure& part : variogram.further)
        part.sill *= factor;
}

}  // namespace realmodel::interpolation
