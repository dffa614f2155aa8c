// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/variogram_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace realmodel::interpolation {

namespace {

constexpr double contradicting = 8;  // times: errors and experimental values ask for such sills
constexpr double hopeless = 2;       // times the best mean square: such a model is not looked into
constexpr double hopeful = 1.3;      // times the best mean square: such a one is made rougher
// A mean square that is less by no more than this, or than that of so many points, may be so by
// chance.
constexpr double told_by_chance = 0.001;
constexpr double points_told_by_chance = 10;
// Of the experimental value at the shortest lag.
constexpr double nuggets_tried[] = {0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
constexpr double ranges_tried[] = {0.25, 0.5, 2, 4};  // times the range that fits the curve best
/// A part that makes surfaces of a model rougher. A small share of a rough model is much at short
/// distances; of the same model at a shorter range less so.
struct RougherPart {
    VariogramModel model;
    double range;  // of the model's
    std::array<double, 4> shares;
};

std::vector<RougherPart> parts_for(VariogramModel model) {
    const RougherPart exponential{VariogramModel::exponential, 1, {0.003, 0.015, 0.07, 0.3}};
    const RougherPart matern32{VariogramModel::matern32, 1, {0.01, 0.03, 0.1, 0.3}};
    const RougherPart shorter{model, 0.25, {0.01, 0.03, 0.08, 0.2}};
    switch (model) {
        case VariogramModel::matern32:
        case VariogramModel::cubic:
            return {exponential, shorter};
        case VariogramModel::matern52:
        case VariogramModel::gaussian:
            return {exponential, matern32};
        default:
            return {};
    }
}

bool usable(const CurveFit& fit) {
    return fit.sill() > 0 && std::isfinite(fit.sill()) && std::isfinite(fit.misfit);
}

/// The numbers of a variogram that are changed to refine it, and by how much.
struct Step {
    double CurveFit::*nugget;
    double Curve::*curve;
    double times;

    bool applies_to(const CurveFit& fit) const {
        return nugget != nullptr ? fit.nugget > 0
                                 : curve == &Curve::range || fit.curve.rough_share > 0;
    }
    void change(CurveFit& fit, bool up) const {
        (nugget != nullptr ? fit.*nugget : fit.curve.*curve) *= up ? times : 1 / times;
    }
};

constexpr Step steps[] = {{nullptr, &Curve::rough_share, 1.8},
                          {nullptr, &Curve::range, 1.4},
                          {nullptr, &Curve::rough_range, 1.6},
                          {&CurveFit::nugget, nullptr, 2}};
constexpr double most_rough = 0.6;  // share of the rougher part

}  // namespace

bool Candidate::contradicts() const {
    return !(std::abs(std::log(sill / fit.sill())) < std::log(contradicting));
}

void keep_agreeing(std::vector<Candidate>& candidates) {
    const auto last =
        std::stable_partition(candidates.begin(), candidates.end(),
                              [](const Candidate& candidate) { return !candidate.contradicts(); });
    if (last != candidates.begin()) candidates.erase(last, candidates.end());
}

const Candidate& best_of(const std::vector<Candidate>& candidates) {
    return *std::min_element(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.square < b.square; });
}

std::vector<VariogramModel> hopeful_models(const std::vector<Candidate>& candidates) {
    const double enough = hopeful * best_of(candidates).square;
    std::vector<VariogramModel> out;
    for (const VariogramModel model : all_variogram_models) {
        const auto is_good = [&](const Candidate& candidate) {
            return candidate.fit.curve.model == model && candidate.square <= enough;
        };
        if (std::any_of(candidates.begin(), candidates.end(), is_good)) out.push_back(model);
    }
    return out;
}

Candidate refined(const Candidate& start, const LeftOutPoints& points,
                  const ExperimentalVariogram& e, const Anisotropy& anisotropy, double longest,
                  const Judge& judge) {
    Candidate best = start;
    longest = std::max(longest, start.fit.curve.range);
    const auto better_by = [&](const Step& step, bool up) {
        CurveFit changed = best.fit;
        step.change(changed, up);
        const Curve& curve = changed.curve;
        if (curve.range > longest || curve.rough_share > most_rough) return false;
        const CurveFit fit = fit_sill(e, curve, changed.nugget);
        if (!usable(fit) || fit.partial_sill <= 0) return false;
        const LeftOutErrors told = points.told_by(Covariance(variogram_of(fit, anisotropy)));
        const Candidate found{fit, honest_sill(told), judge(told.errors)};
        const auto count = static_cast<double>(told.errors.size());
        const double by_chance = std::max(told_by_chance, points_told_by_chance / count);
        if (found.contradicts() || !(found.square < (1 - by_chance) * best.square)) return false;
        best = found;
        return true;
    };
    for (const Step& step : steps) {
        if (!step.applies_to(best.fit)) continue;
        if (better_by(step, true)) {
            better_by(step, true);
        } else if (better_by(step, false)) {
            better_by(step, false);
        }
    }
    return best;
}

/// What fits the experimental values best, of each model with and without a nugget.
void VariogramSearch::start(std::span<const VariogramModel> models, std::optional<Judge>& judge) {
    std::vector<std::vector<double>> errors;
    for (const VariogramModel model : models) {
        for (const bool with_nugget : {true, false}) {
            const CurveFit fit = fit_curve(e_, model, with_nugget);
            if (!usable(fit)) continue;
            LeftOutErrors told = points_.told_by(Covariance(variogram_of(fit, anisotropy_)));
            all_.push_back({fit, honest_sill(told), 0});
            errors.push_back(std::move(told.errors));
        }
    }
    if (errors.empty()) return;
    if (!judge) {
        std::size_t best = 0;
        double least = 0;
        for (std::size_t i = 0; i < errors.size(); ++i) {
            std::vector<double> sizes;
            for (const double error : errors[i])
                sizes.push_back(std::abs(error));
            const double median = quantile(std::move(sizes), 0.5);
            if (i > 0 && !(median < least)) continue;
            least = median;
            best = i;
        }
        judge.emplace(errors[best]);
    }
    for (std::size_t i = 0; i < errors.size(); ++i)
        all_[i].square = (*judge)(errors[i]);
    judge_ = &*judge;
}

std::vector<Candidate> VariogramSearch::run(std::span<const VariogramModel> models,
                                            std::optional<Judge>& judge) {
    start(models, judge);
    report_(0.2);
    if (all_.empty()) return {};
    const auto count = static_cast<double>(models.size());
    const double enough = hopeless * best_of(all_).square;
    double done = 0;
    for (const VariogramModel model : models) {
        const Candidate* const start = best_with(model);
        if (start != nullptr && start->square <= enough) vary(Candidate(*start));
        report_(0.2 + 0.5 * ++done / count);
    }
    done = 0;
    for (const VariogramModel model : models) {
        roughen(model);
        report_(0.7 + 0.3 * ++done / count);
    }
    return std::move(all_);
}

/// The one of a model that tells points best, so far.
const Candidate* VariogramSearch::best_with(VariogramModel model) const {
    const Candidate* best = nullptr;
    for (const Candidate& candidate : all_) {
        if (candidate.fit.curve.model != model) continue;
        if (best == nullptr || candidate.square < best->square) best = &candidate;
    }
    return best;
}

/// With the sill that fits the experimental values best.
void VariogramSearch::attempt(const Curve& curve, double nugget, double longest) {
    if (curve.range > longest) return;
    const CurveFit fit = fit_sill(e_, curve, nugget);
    if (!usable(fit) || fit.partial_sill <= 0) return;
    const LeftOutErrors told = points_.told_by(Covariance(variogram_of(fit, anisotropy_)));
    all_.push_back({fit, honest_sill(told), (*judge_)(told.errors)});
}

/// Nuggets, then ranges, then nuggets again.
void VariogramSearch::vary(const Candidate& start) {
    const VariogramModel model = start.fit.curve.model;
    const double longest = std::max(start.fit.curve.range, longest_);
    for (const double share : nuggets_tried)
        attempt(start.fit.curve, share * e_.gamma.front(), longest);
    const CurveFit with_nugget = best_with(model)->fit;
    for (const double times : ranges_tried) {
        Curve curve = with_nugget.curve;
        curve.range *= times;
        attempt(curve, with_nugget.nugget, longest);
    }
    const CurveFit with_range = best_with(model)->fit;
    for (const double times : {0.3, 3.0}) {
        const double nugget = with_range.nugget > 0 ? with_range.nugget : 1e-3 * e_.gamma.front();
        attempt(with_range.curve, nugget * times, longest);
    }
}

/// A rougher part instead of the nugget, then beside it, and other ranges with it.
void VariogramSearch::roughen(VariogramModel model) {
    const std::vector<RougherPart> parts = parts_for(model);
    const Candidate* const plain = best_with(model);
    if (parts.empty() || plain == nullptr || plain->square > hopeful * best_of(all_).square) return;
    const CurveFit start = plain->fit;
    const double longest = std::max(start.curve.range, longest_);
    for (const RougherPart& part : parts) {
        for (const double share : part.shares) {
            Curve curve = start.curve;
            curve.rougher = part.model;
            curve.rough_range = part.range;
            curve.rough_share = share;
            attempt(curve, 0, longest);
        }
    }
    for (int round = 0; round < 2; ++round) {
        const CurveFit best = best_with(model)->fit;
        if (best.curve.rough_share == 0) return;
        if (round == 0) {
            for (const double times : {0.5, 2.0}) {
                Curve curve = best.curve;
                curve.range *= times;
                attempt(curve, best.nugget, longest);
            }
            if (start.nugget > 0) attempt(best.curve, start.nugget, longest);
            continue;
        }
        for (const double times : {0.55, 1.8}) {
            Curve curve = best.curve;
            curve.rough_share *= times;
            attempt(curve, best.nugget, longest);
        }
    }
}

}  // namespace realmodel::interpolation
