// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "interpolation/variogram/anisotropy_search.hpp"
#include "interpolation/drift_basis.hpp"
#include "interpolation/variogram/experimental_variogram.hpp"
#include "interpolation/variogram/capped_square.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/variogram_search.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t points_left_out = 10'000;
constexpr std::size_t points_searched = 4000;
constexpr std::size_t neighbours_searched = 16;
constexpr std::size_t points_left_out_of_drift = 1000;
constexpr double as_good = 1.004;     // of mean squares: RMS errors within 0.2 % tell nothing apart
constexpr double nearly_best = 1.05;  // of mean squares: what few points say of others
constexpr std::size_t finalists = 8;
constexpr std::size_t least_for_anisotropy = 30;  // points
constexpr double shown_by_few = 200;    // points: fewer tell less of how honest variances are than
                                        // pairs of them tell of the curve
constexpr double hardly_worse = 1.002;  // of mean squares, for the sake of honest variances
// A sill far below what distant pairs show would make variances far from points too small.
constexpr double least_scale = 0.25;

/// The choice among models, ranges, nuggets and anisotropies by points left out.
class Choice {
public:
    Choice(const DataPoints& data, const FitOptions& options, Progress* progress)
        : data_(data),
          options_(options),
          progress_(progress),
          points_(data, static_cast<std::size_t>(options.neighbours), points_left_out,
                  options.threads, progress),
          few_(data, std::min(static_cast<std::size_t>(options.neighbours), neighbours_searched),
               points_searched, options.threads, progress) {}

    /// Leaves out as it is where no model fits at all. Its experimental values and its variogram's
    /// anisotropy are given; they change where an anisotropy is found.
    void make(FittedVariogram& out) {
        const bool finds = options_.finds_anisotropy &&
                           data_.local.size() >= least_for_anisotropy && spread_in_plan(data_);
        std::vector<Candidate> all = search(out, all_variogram_models, 0, finds ? 0.35 : 0.7);
        if (all.empty()) return;
        if (finds) {
            const CurveFit best = best_of(all).fit;
            const Anisotropy found = find_anisotropy(few_, best, *judge_);
            if (found.ratio > 1 && better_with(found, best)) {
                out.variogram.anisotropy = found;
                out.experimental = experimental_variogram(data_, found);
                all = search(out, hopeful_models(all), 0.4, 0.75);
            }
        }
        const Anisotropy& anisotropy = out.variogram.anisotropy;
        const Candidate chosen = last_choice(std::move(all), anisotropy);
        report(0.85);
        const Candidate best =
            refined(chosen, points_, out.experimental, anisotropy, extent(anisotropy), *judge_);
        report(0.95);
        out.variogram = variogram_of(best.fit, out.variogram.anisotropy);
        make_honest(out, best.square);
    }

private:
    void report(double share) const {
        if (progress_ == nullptr) return;
        progress_->report(share, "fitting the variogram");
        progress_->check();
    }

    double extent(const Anisotropy& anisotropy) const {
        return diagonal(isotropic_places(data_, anisotropy));
    }

    std::vector<Candidate> search(const FittedVariogram& about,
                                  std::span<const VariogramModel> models, double from, double to) {
        const Anisotropy& anisotropy = about.variogram.anisotropy;
        VariogramSearch search(few_, about.experimental, anisotropy, extent(anisotropy),
                               [&](double share) { report(from + share * (to - from)); });
        std::vector<Candidate> all = search.run(models, judge_);
        keep_agreeing(all);
        return all;
    }

    bool better_with(const Anisotropy& found, const CurveFit& fit) const {
        const LeftOutErrors without = points_.told_by(Covariance(variogram_of(fit, {})));
        const LeftOutErrors with =
            points_.told_by(Covariance(variogram_of(stretched(fit, found), found)));
        return judge_->surely_less(with.errors, without.errors);
    }

    /// By all the points, of those that a part of them tells best. Of those that tell points
    /// equally well one without a rough part, and of these the one that fits the experimental
    /// values best.
    Candidate last_choice(std::vector<Candidate> all, const Anisotropy& anisotropy) const {
        std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
            return a.square < b.square;
        });
        const double enough = nearly_best * all.front().square;
        while (all.size() > 1 && (all.size() > finalists || all.back().square > enough))
            all.pop_back();
        double least = std::numeric_limits<double>::infinity();
        for (Candidate& candidate : all) {
            const Covariance covariance(variogram_of(candidate.fit, anisotropy));
            candidate.square = (*judge_)(points_.told_by(covariance).errors);
            least = std::min(least, candidate.square);
        }
        const auto rank = [](const Candidate& candidate) {
            return std::pair(candidate.fit.curve.rough_share > 0, candidate.fit.misfit);
        };
        const Candidate* best = nullptr;
        for (const Candidate& candidate : all) {
            if (candidate.square > as_good * least) continue;
            if (best == nullptr || rank(candidate) < rank(*best)) best = &candidate;
        }
        return *best;
    }

    /// Moves ranges and sill so that as many errors lie within two deviations as should. Near
    /// points the range does it, which hardly changes what is told, and the sill stays that of far
    /// pairs; what is left is the sill's to do.
    void make_honest(FittedVariogram& out, double square) const {
        Variogram& variogram = out.variogram;
        const bool drifts = options_.drift != Drift::constant;
        std::optional<LeftOutPoints> fewer;
        if (drifts) {
            fewer.emplace(data_, points_.neighbours(), points_left_out_of_drift, options_.threads,
                          progress_);
        }
        const LeftOutPoints& points = drifts ? *fewer : points_;
        const auto told = [&](const Variogram& v) {
            return points.told_by(Covariance(v), options_.drift);
        };
        LeftOutErrors errors = told(variogram);
        if (drifts) square = (*judge_)(errors.errors);
        double scale = honest_sill(errors) / variogram.sill;
        if (!(scale > 0) || !std::isfinite(scale)) return;
        // Of what the errors ask for, as much as so many of them are worth.
        const auto count = static_cast<double>(errors.errors.size());
        const double left_undone = std::pow(scale, shown_by_few / (count + shown_by_few));
        scale /= left_undone;
        const double power = growth(variogram, out.experimental.lags.front());
        const double longest = std::max(variogram.range, extent(variogram.anisotropy));
        double reach = 1;  // of the way that would do it all
        for (int step = 0; step < 4 && std::abs(std::log(scale)) > 0.05; ++step) {
            const double times = std::min(std::clamp(std::pow(scale, -reach / power), 0.5, 2.0),
                                          std::max(longest / variogram.range, 1.0));
            Variogram moved = variogram;
            moved.range *= times;
            for (NestedStructure& part : moved.further)
                part.range *= times;
            LeftOutErrors with_moved = told(moved);
            const double with_range = honest_sill(with_moved) / moved.sill / left_undone;
            if (!(std::abs(std::log(with_range)) < std::abs(std::log(scale))) ||
                (*judge_)(with_moved.errors) > hardly_worse * square) {
                reach /= 2;
                continue;
            }
            variogram = moved;
            scale = with_range;
        }
        scale = std::max(scale, least_scale);
        variogram.sill *= scale;
        variogram.nugget *= scale;
        for (NestedStructure& part : variogram.further)
            part.sill *= scale;
    }

    /// The variance that kriging leaves open grows as this power of short distances; of a sum, as
    /// its parts do where they leave most at this distance.
    static double growth(const Variogram& variogram, double distance) {
        double open = 0, powers = 0;
        const auto add = [&](VariogramModel model, double range, double sill) {
            const double power = growth(model);
            const double part = sill * std::pow(distance / range, power);
            open += part;
            powers += part * power;
        };
        add(variogram.model, variogram.range, variogram.first_sill());
        for (const NestedStructure& part : variogram.further)
            add(part.model, part.range, part.sill);
        return open > 0 && std::isfinite(powers) ? powers / open : growth(variogram.model);
    }

    static double growth(VariogramModel model) {
        switch (model) {
            case VariogramModel::spherical:
            case VariogramModel::exponential:
                return 1;
            case VariogramModel::cubic:
            case VariogramModel::matern32:
                return 3;  // of what kriging leaves open; gamma itself grows as the square
            case VariogramModel::matern52:
                return 5;
            case VariogramModel::gaussian:
                return 8;
        }
        return 1;
    }

    const DataPoints& data_;
    const FitOptions& options_;
    Progress* progress_;
    LeftOutPoints points_, few_;  // all that are left out, and those that search
    std::optional<Judge> judge_;
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
                              const Anisotropy& given_anisotropy, Progress* progress,
                              const FitOptions& options) {
    const Anisotropy anisotropy = options.finds_anisotropy ? Anisotropy{} : given_anisotropy;
    check_anisotropy(anisotropy);
    if (options.neighbours < 1) {
        throw InputError("option", "a variogram is fitted with at least one neighbour");
    }
    DataPoints data = prepare_points(points);
    const std::vector<double> given = data.values;
    // Kriging with the drift says the same of what is left of the values without one.
    if (options.drift != Drift::constant) data.values = without_drift(data, options.drift);
    FittedVariogram out;
    out.experimental = experimental_variogram(data, anisotropy);
    const ExperimentalVariogram& e = out.experimental;
    out.variogram = plain_variogram(data, given, e, anisotropy);
    const bool varies = !e.gamma.empty() && *std::max_element(e.gamma.begin(), e.gamma.end()) >
                                                1e-12 * out.variogram.sill;
    if (data.local.size() < 3 || e.lags.size() < 2 || !varies) return out;
    Choice(data, options, progress).make(out);
    return out;
}

}  // namespace realmodel::interpolation
