// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "interpolation/drift_kriging.hpp"
#include "interpolation/experimental_variogram.hpp"
#include "interpolation/local_kriging.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t points_left_out = 1000;
constexpr std::size_t neighbours_of_left_out = 16;
constexpr int ranges_tried = 48;
constexpr double as_good = 1.02;  // RMS errors within 1 % do not tell models apart

/// Nugget and sill that fit best for one model and range.
struct Fit {
    double misfit = std::numeric_limits<double>::infinity();  // weighted sum of squares
    double range = 1, nugget = 0, partial_sill = 0;
};

/// Minimises sum w (gamma - nugget - partial f)^2 with both not negative: a linear problem.
Fit fit_for_range(const ExperimentalVariogram& e, VariogramModel model, double range,
                  bool with_nugget) {
    double w1 = 0, wf = 0, wff = 0, wg = 0, wfg = 0;
    for (std::size_t i = 0; i < e.lags.size(); ++i) {
        const double weight = static_cast<double>(e.pairs[i]) / (e.lags[i] * e.lags[i]);
        const double f = structure(model, e.lags[i] / range);
        w1 += weight;
        wf += weight * f;
        wff += weight * f * f;
        wg += weight * e.gamma[i];
        wfg += weight * f * e.gamma[i];
    }
    Fit fit;
    fit.range = range;
    const double determinant = w1 * wff - wf * wf;
    fit.nugget =
        with_nugget && determinant > 1e-12 * w1 * wff ? (wff * wg - wf * wfg) / determinant : 0;
    fit.nugget = std::max(fit.nugget, 0.0);
    fit.partial_sill = wff > 0 ? (wfg - fit.nugget * wf) / wff : 0;
    if (fit.partial_sill < 0) {
        fit.partial_sill = 0;
        fit.nugget = with_nugget ? wg / w1 : 0;
    }
    fit.misfit = 0;
    for (std::size_t i = 0; i < e.lags.size(); ++i) {
        const double weight = static_cast<double>(e.pairs[i]) / (e.lags[i] * e.lags[i]);
        const double f = structure(model, e.lags[i] / range);
        fit.misfit += weight * std::pow(e.gamma[i] - fit.nugget - fit.partial_sill * f, 2);
    }
    return fit;
}

/// Best range for one model: tried on a geometric scale, then narrowed by golden sections.
Fit fit_model(const ExperimentalVariogram& e, VariogramModel model, bool with_nugget) {
    const double shortest = 0.5 * e.lags.front(), longest = 4 * e.lags.back();
    const double step = std::pow(longest / shortest, 1.0 / ranges_tried);
    const auto at = [&](double range) { return fit_for_range(e, model, range, with_nugget); };
    Fit best;
    for (int i = 0; i <= ranges_tried; ++i) {
        const Fit fit = at(shortest * std::pow(step, i));
        if (fit.misfit < best.misfit) best = fit;
    }
    constexpr double golden = 0.6180339887498949;
    double low = best.range / step, high = std::min(best.range * step, longest);
    for (int i = 0; i < 40; ++i) {
        const double span = golden * (high - low);
        const Fit a = at(high - span), b = at(low + span);
        if (a.misfit < b.misfit) {
            high = b.range;
        } else {
            low = a.range;
        }
        for (const Fit& fit : {a, b}) {
            if (fit.misfit < best.misfit) best = fit;
        }
    }
    return best;
}

/// Points left out one by one and told by kriging from the others.
class LeaveOneOut {
public:
    LeaveOneOut(const DataPoints& data, Drift drift) : data_(data), drift_(drift) {
        const std::size_t count = data.local.size();
        const spatial::NearestPoints tree(data.local);
        const std::size_t taken = std::min(count, points_left_out);
        std::vector<spatial::Neighbour> found;
        for (std::size_t k = 0; k < taken; ++k) {
            const std::size_t point = k * count / taken;
            tree.find(data.local[point], neighbours_of_left_out + 1, found);
            std::erase_if(found, [&](const spatial::Neighbour& n) {
                return static_cast<std::size_t>(n.point) == point;
            });
            left_out_.push_back({point, found});
        }
    }

    /// Mean squared error, and mean surprise: log variance + squared error / variance, twice the
    /// negative logarithm of the errors' normal density but for a constant (Sundararajan and
    /// Keerthi 2001, "Predictive approaches for choosing hyperparameters in Gaussian processes").
    struct Score {
        double square, surprise;
    };
    Score score(const Variogram& variogram) const {
        const Covariance covariance(variogram);
        return drift_ == Drift::constant
                   ? score_of(LocalKriging(data_, covariance), variogram.sill)
                   : score_of(DriftKriging(data_, covariance, drift_), variogram.sill);
    }

private:
    template <class LocalSystem>
    Score score_of(LocalSystem kriging, double sill) const {
        Score sum{0, 0};
        for (const auto& [point, others] : left_out_) {
            const Estimate estimate = kriging.at(data_.local[point], others, [] { return false; });
            const double square = std::pow(estimate.value - data_.values[point], 2);
            // Where neighbours nearly coincide the variance is rounding: it must not decide.
            const double variance = sill * std::max(estimate.variance, 1e-9);
            sum.square += square;
            sum.surprise += std::log(variance) + square / variance;
        }
        const auto count = static_cast<double>(left_out_.size());
        return {sum.square / count, sum.surprise / count};
    }

    struct LeftOut {
        std::size_t point;
        std::vector<spatial::Neighbour> others;
    };
    const DataPoints& data_;
    Drift drift_;
    std::vector<LeftOut> left_out_;
};

/// What is said of points that show no variation, or are too few to show any.
Variogram plain_variogram(const DataPoints& data, std::span<const double> given,
                          const ExperimentalVariogram& e, const Anisotropy& anisotropy) {
    double largest = 1;
    for (const double z : given)
        largest = std::max(largest, std::abs(z));
    const double length = diagonal(isotropic_places(data, anisotropy));
    Variogram variogram;
    variogram.anisotropy = anisotropy;
    variogram.range = length > 0 ? length : 1;
    const double shown = e.gamma.empty() ? 0 : *std::max_element(e.gamma.begin(), e.gamma.end());
    variogram.sill = std::max(shown, 1e-12 * largest * largest);
    return variogram;
}

}  // namespace

FittedVariogram fit_variogram(std::span<const std::array<double, 3>> points,
                              const Anisotropy& anisotropy, Progress* progress, Drift drift) {
    check_anisotropy(anisotropy);
    DataPoints data = prepare_points(points);
    const std::vector<double> given = data.values;
    // Kriging with the drift says the same of what is left of the values without one.
    if (drift != Drift::constant) data.values = without_drift(data, drift);
    FittedVariogram out;
    out.experimental = experimental_variogram(data, anisotropy);
    const ExperimentalVariogram& e = out.experimental;
    out.variogram = plain_variogram(data, given, e, anisotropy);
    const bool varies = !e.gamma.empty() && *std::max_element(e.gamma.begin(), e.gamma.end()) >
                                                1e-12 * out.variogram.sill;
    if (data.local.size() < 3 || e.lags.size() < 2 || !varies) return out;

    const LeaveOneOut leave_one_out(data, drift);
    struct Candidate {
        Variogram variogram;
        LeaveOneOut::Score score;
    };
    std::vector<Candidate> candidates;
    double least_square = std::numeric_limits<double>::infinity();
    for (const VariogramModel model : all_variogram_models) {
        for (const bool with_nugget : {true, false}) {
            if (progress != nullptr) {
                progress->report(static_cast<double>(candidates.size()) / 12,
                                 "fitting the variogram");
                progress->check();
            }
            const Fit fit = fit_model(e, model, with_nugget);
            const Variogram variogram{model,      fit.range,  fit.nugget + fit.partial_sill,
                                      fit.nugget, anisotropy, {}};
            if (!(variogram.sill > 0) || !std::isfinite(variogram.sill)) continue;
            candidates.push_back({variogram, leave_one_out.score(variogram)});
            least_square = std::min(least_square, candidates.back().score.square);
        }
    }
    double least_surprise = std::numeric_limits<double>::infinity();
    for (const auto& [variogram, score] : candidates) {
        if (score.square > as_good * least_square || score.surprise >= least_surprise) continue;
        least_surprise = score.surprise;
        out.variogram = variogram;
    }
    return out;
}

}  // namespace realmodel::interpolation
