// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/variogram_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kContradicting =
    8;                            // times: the sills that errors and experimental values ask for
constexpr double kHopeless = 2;   // times the best mean square: such a model is not varied
constexpr double kHopeful = 1.3;  // times the best mean square: such a one is made rougher
// A mean square that is lower by no more than this share, or by the share of so many points, may be
// so by chance.
constexpr double kChanceShare = 0.001;
constexpr double kChancePoints = 10;
// Of the experimental value at the shortest lag.
constexpr double kNuggetsTried[] = {0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
constexpr double kNone[] = {0};
constexpr double kRangeFactors[] = {0.25, 0.5, 2, 4};  // times the range that fits the curve best

/// A part that makes surfaces of a model rougher. A small share of a rough model is much at short
/// distances; of the same model at a shorter range less so.
struct RougherStructure {
    VariogramModel model;
    double range;  // of the model's
    std::array<double, 4> shares;
};

std::vector<RougherStructure> rougher_structures(VariogramModel model) {
    const RougherStructure exponential{VariogramModel::kExponential, 1, {0.003, 0.015, 0.07, 0.3}};
    const RougherStructure matern32{VariogramModel::kMatern32, 1, {0.01, 0.03, 0.1, 0.3}};
    const RougherStructure shorter{model, 0.25, {0.01, 0.03, 0.08, 0.2}};
    switch (model) {
        case VariogramModel::kMatern32:
        case VariogramModel::kCubic:
            return {exponential, shorter};
        case VariogramModel::kMatern52:
        case VariogramModel::kGaussian:
            return {exponential, matern32};
        default:
            return {};
    }
}

bool usable(const CurveFit& fit) {
    return fit.sill() > 0 && std::isfinite(fit.sill()) && std::isfinite(fit.misfit);
}

/// The numbers of a variogram that are changed to refine it, and by how much.
struct RefinementStep {
    double CurveFit::*nugget;
    double VariogramCurve::*curve;
    double times;

    bool applies_to(const CurveFit& fit) const {
        return nugget != nullptr ? fit.nugget > 0
                                 : curve == &VariogramCurve::range || fit.curve.rough_share > 0;
    }
    void change(CurveFit& fit, bool up) const {
        (nugget != nullptr ? fit.*nugget : fit.curve.*curve) *= up ? times : 1 / times;
    }
};

constexpr RefinementStep kSteps[] = {{nullptr, &VariogramCurve::rough_share, 1.8},
                                     {nullptr, &VariogramCurve::range, 1.4},
                                     {nullptr, &VariogramCurve::rough_range, 1.6},
                                     {&CurveFit::nugget, nullptr, 2}};
constexpr double kMostRough = 0.6;  // share of the rougher structure

}  // namespace

bool VariogramCandidate::contradicts() const {
    return !(std::abs(elementary::log(sill / fit.sill())) < elementary::log(kContradicting));
}

void keep_agreeing(std::vector<VariogramCandidate>& candidates) {
    if (std::ranges::all_of(candidates, &VariogramCandidate::contradicts)) return;
    std::erase_if(candidates, std::mem_fn(&VariogramCandidate::contradicts));
}

const VariogramCandidate& best_of(const std::vector<VariogramCandidate>& candidates) {
    return *std::ranges::min_element(candidates, {}, &VariogramCandidate::square);
}

std::vector<VariogramModel> hopeful_models(const std::vector<VariogramCandidate>& candidates) {
    const double enough = kHopeful * best_of(candidates).square;
    std::vector<VariogramModel> out;
    for (const VariogramModel model : kRisingModels) {
        const auto is_good = [&](const VariogramCandidate& candidate) {
            return candidate.fit.curve.model == model && candidate.square <= enough;
        };
        if (std::any_of(candidates.begin(), candidates.end(), is_good)) out.push_back(model);
    }
    return out;
}

/// With the sill that fits the experimental values best, where there is one.
std::optional<CurveFit> VariogramSearch::with_sill(const VariogramCurve& curve,
                                                   double nugget) const {
    const CurveFit fit = fit_sill(e_, curve, nugget);
    if (!usable(fit) || fit.partial_sill <= 0) return std::nullopt;
    return fit;
}

VariogramCandidate VariogramSearch::judged(const CurveFit& fit,
                                           const PredictionErrors& predictions) const {
    return {fit, honest_sill(predictions), (*square_of_)(predictions.errors)};
}

std::optional<VariogramCandidate> VariogramSearch::candidate(const VariogramCurve& curve,
                                                             double nugget) const {
    const std::optional<CurveFit> fit = with_sill(curve, nugget);
    if (!fit) return std::nullopt;
    return judged(*fit, points_.errors(Covariance(variogram_of(*fit, anisotropy_))));
}

VariogramCandidate VariogramSearch::refined(const VariogramCandidate& start) const {
    VariogramCandidate best = start;
    const double longest = std::max(longest_, start.fit.curve.range);
    const double by_chance =
        std::max(kChanceShare, kChancePoints / static_cast<double>(points_.size()));
    const auto better_by = [&](const RefinementStep& step, bool up) {
        CurveFit changed = best.fit;
        step.change(changed, up);
        const VariogramCurve& curve = changed.curve;
        if (curve.range > longest || curve.rough_share > kMostRough) return false;
        const std::optional<VariogramCandidate> trial = candidate(curve, changed.nugget);
        if (!trial || trial->contradicts()) return false;
        if (!(trial->square < (1 - by_chance) * best.square)) return false;
        best = *trial;
        return true;
    };
    for (const RefinementStep& step : kSteps) {
        if (!step.applies_to(best.fit)) continue;
        for (const bool up : {true, false}) {
            if (!better_by(step, up)) continue;
            better_by(step, up);
            break;
        }
    }
    return best;
}

/// What fits the experimental values best, of each model with and without a nugget.
void VariogramSearch::start(std::span<const VariogramModel> models) {
    std::vector<std::vector<double>> errors;
    for (const VariogramModel model : models) {
        for (const bool with_nugget : {true, false}) {
            const CurveFit fit = fit_curve(e_, model, with_nugget);
            if (!usable(fit)) continue;
            PredictionErrors predictions =
                points_.errors(Covariance(variogram_of(fit, anisotropy_)));
            all_.push_back({fit, honest_sill(predictions), 0});
            errors.push_back(std::move(predictions.errors));
        }
    }
    if (errors.empty()) return;
    if (!square_of_) {
        const auto median = [](const std::vector<double>& of) {
            std::vector<double> sizes;
            for (const double error : of)
                sizes.push_back(std::abs(error));
            return quantile(std::move(sizes), 0.5);
        };
        std::vector<double> medians;
        for (const std::vector<double>& of : errors)
            medians.push_back(median(of));
        const auto best = std::min_element(medians.begin(), medians.end());
        square_of_.emplace(errors[static_cast<std::size_t>(best - medians.begin())]);
    }
    for (std::size_t i = 0; i < errors.size(); ++i)
        all_[i].square = (*square_of_)(errors[i]);
}

std::vector<VariogramCandidate> VariogramSearch::run(std::span<const VariogramModel> models,
                                                     const std::function<void(double)>& report) {
    start(models);
    report(0.2);
    if (all_.empty()) return {};
    const auto count = static_cast<double>(models.size());
    const double enough = kHopeless * best_of(all_).square;
    double done = 0;
    for (const VariogramModel model : models) {
        const VariogramCandidate* const start = best_with(model);
        if (start != nullptr && start->square <= enough) vary(VariogramCandidate(*start));
        report(0.2 + 0.5 * ++done / count);
    }
    done = 0;
    for (const VariogramModel model : models) {
        roughen(model);
        report(0.7 + 0.3 * ++done / count);
    }
    return std::move(all_);
}

/// The best of a model so far.
const VariogramCandidate* VariogramSearch::best_with(VariogramModel model) const {
    const VariogramCandidate* best = nullptr;
    for (const VariogramCandidate& candidate : all_) {
        if (candidate.fit.curve.model != model) continue;
        if (best == nullptr || candidate.square < best->square) best = &candidate;
    }
    return best;
}

/// One curve with some nuggets, and with some shares of its rougher structure.
void VariogramSearch::attempt(const VariogramCurve& curve, std::span<const double> nuggets,
                              std::span<const double> rough_shares, double longest) {
    if (curve.range > longest) return;
    std::vector<CurveFit> fits;
    std::vector<Covariance> covariances;
    for (const double rough_share : rough_shares) {
        for (const double nugget : nuggets) {
            VariogramCurve trial_curve = curve;
            trial_curve.rough_share = rough_share;
            const std::optional<CurveFit> fit = with_sill(trial_curve, nugget);
            if (!fit) continue;
            fits.push_back(*fit);
            covariances.emplace_back(variogram_of(*fit, anisotropy_));
        }
    }
    const std::vector<PredictionErrors> predictions = points_.errors(covariances);
    for (std::size_t k = 0; k < fits.size(); ++k)
        all_.push_back(judged(fits[k], predictions[k]));
}

/// Nuggets, then ranges, then nuggets again.
void VariogramSearch::vary(const VariogramCandidate& start) {
    const VariogramModel model = start.fit.curve.model;
    const double longest = std::max(start.fit.curve.range, longest_);
    std::vector<double> nuggets;
    for (const double share : kNuggetsTried)
        nuggets.push_back(share * e_.gamma.front());
    attempt(start.fit.curve, nuggets, {&start.fit.curve.rough_share, 1}, longest);
    const CurveFit with_nugget = best_with(model)->fit;
    for (const double times : kRangeFactors) {
        VariogramCurve curve = with_nugget.curve;
        curve.range *= times;
        attempt(curve, with_nugget.nugget, longest);
    }
    const CurveFit with_range = best_with(model)->fit;
    const double nugget = with_range.nugget > 0 ? with_range.nugget : 1e-3 * e_.gamma.front();
    const double around[] = {0.3 * nugget, 3 * nugget};
    attempt(with_range.curve, around, {&with_range.curve.rough_share, 1}, longest);
}

/// A rougher structure instead of the nugget, then beside it, and other ranges with it.
void VariogramSearch::roughen(VariogramModel model) {
    const std::vector<RougherStructure> structures = rougher_structures(model);
    const VariogramCandidate* const plain = best_with(model);
    if (structures.empty() || plain == nullptr || plain->square > kHopeful * best_of(all_).square)
        return;
    const CurveFit start = plain->fit;
    const double longest = std::max(start.curve.range, longest_);
    for (const RougherStructure& structure : structures) {
        VariogramCurve curve = start.curve;
        curve.rougher = structure.model;
        curve.rough_range = structure.range;
        attempt(curve, kNone, structure.shares, longest);
    }
    for (int round = 0; round < 2; ++round) {
        const CurveFit best = best_with(model)->fit;
        if (best.curve.rough_share == 0) return;
        if (round == 0) {
            for (const double times : {0.5, 2.0}) {
                VariogramCurve curve = best.curve;
                curve.range *= times;
                attempt(curve, best.nugget, longest);
            }
            if (start.nugget > 0) attempt(best.curve, start.nugget, longest);
            continue;
        }
        const double around[] = {0.55 * best.curve.rough_share, 1.8 * best.curve.rough_share};
        attempt(best.curve, {&best.nugget, 1}, around, longest);
    }
}

namespace {

constexpr double kLargestRatio = 4;
constexpr double kFirstRatios[] = {1.4, 2.2};
constexpr int kDirections = 6;
constexpr double kFirstStep = 0.25, kLastStep = 0.03;  // of the logarithm of the ratio
constexpr double kLeastSpread = 0.05;                  // across, of that along

/// The logarithm of the ratio as length, twice the azimuth as direction: continuous, also where the
/// azimuth passes 180 degrees and where there is no anisotropy.
using PlanVector = std::array<double, 2>;

Anisotropy anisotropy_of(const PlanVector& v) {
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
    const auto square = [&](const PlanVector& v) {
        const Anisotropy anisotropy = anisotropy_of(v);
        const Variogram variogram = variogram_of(stretched(fit, anisotropy), anisotropy);
        return square_of(points.errors(Covariance(variogram)).errors);
    };
    PlanVector best{0, 0};
    double least = square(best);
    const auto attempt = [&](const PlanVector& v) {
        const double mean_square = square(v);
        if (!(mean_square < least)) return false;
        least = mean_square;
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
        for (const PlanVector& direction :
             {PlanVector{1, 0}, PlanVector{0, 1}, PlanVector{-1, 0}, PlanVector{0, -1}}) {
            const PlanVector v{best[0] + step * direction[0], best[1] + step * direction[1]};
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
