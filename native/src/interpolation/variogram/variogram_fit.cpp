// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "interpolation/drift_basis.hpp"
#include "interpolation/variogram/experimental_variogram.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/likelihood.hpp"
#include "interpolation/variogram/many_points.hpp"
#include "interpolation/variogram/variogram_search.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

// More take longer and predict no better (docs/dev/log/mechanisms.md).
constexpr std::size_t kPointsLeftOut = 4000;
constexpr std::size_t kPointsSearched = 1500;
constexpr std::size_t kNeighborsSearched = 16;
constexpr std::size_t kPointsLeftOutOfDrift = 1000;
constexpr double kAsGood = 1.004;     // of mean squares: RMS errors within 0.2 % are equally good
constexpr double kNearlyBest = 1.05;  // of mean squares, by few points
constexpr std::size_t kFinalists = 8;
constexpr std::size_t kLeastForAnisotropy = 30;  // points
// Fewer points show less of how honest variances are than pairs of them show of the curve.
constexpr double kFewPoints = 200;
constexpr double kHardlyWorse = 1.002;  // of mean squares, for the sake of honest variances
// A sill far below what distant pairs show would make variances far from points too small.
constexpr double kLeastScale = 0.25;

/// The choice among models, ranges, nuggets and anisotropies by points left out.
class ModelSelection {
public:
    ModelSelection(const ManyPoints& all, const FitOptions& options, const Execution& execution)
        : all_(all),
          options_(options),
          execution_(execution),
          buffer_(buffer_of_clusters(all, execution)),
          points_(all, static_cast<std::size_t>(options.neighbors), kPointsLeftOut, buffer_,
                  execution),
          few_(all, std::min(static_cast<std::size_t>(options.neighbors), kNeighborsSearched),
               kPointsSearched, buffer_, execution) {}

    /// Leaves `out` as it is where no model fits at all. Its experimental values and its
    /// variogram's anisotropy are given; they change where an anisotropy is found.
    void make(FittedVariogram& out) {
        const bool finds =
            options_.finds_anisotropy && all_.size() >= kLeastForAnisotropy && spread_in_plan(all_);
        std::vector<VariogramCandidate> all = search(out, kRisingModels, 0, finds ? 0.35 : 0.7);
        if (all.empty()) return;
        if (finds) {
            const CurveFit best = best_of(all).fit;
            const Anisotropy anisotropy = find_anisotropy(few_, best, *square_of_);
            if (anisotropy.ratio > 1 && better_with(anisotropy, best)) {
                out.variogram.anisotropy = anisotropy;
                out.experimental = experimental_variogram(all_, anisotropy, execution_.progress);
                all = search(out, hopeful_models(all), 0.4, 0.75);
            }
        }
        const Anisotropy& anisotropy = out.variogram.anisotropy;
        const VariogramCandidate chosen = last_choice(std::move(all), anisotropy);
        report(0.85);
        const VariogramSearch by_all(points_, out.experimental, anisotropy, extent(anisotropy),
                                     square_of_);
        const VariogramCandidate best = by_all.refined(chosen);
        report(0.95);
        out.variogram = variogram_of(best.fit, out.variogram.anisotropy);
        make_honest(out, best.square);
    }

private:
    void report(double share) const {
        if (execution_.progress == nullptr) return;
        execution_.progress->report(share, "fitting the variogram");
        execution_.progress->check();
    }

    double extent(const Anisotropy& anisotropy) const {
        return all_.diagonal(IsotropicSpace(anisotropy));
    }

    std::vector<VariogramCandidate> search(const FittedVariogram& about,
                                           std::span<const VariogramModel> models, double from,
                                           double to) {
        const Anisotropy& anisotropy = about.variogram.anisotropy;
        VariogramSearch search(few_, about.experimental, anisotropy, extent(anisotropy),
                               square_of_);
        std::vector<VariogramCandidate> all =
            search.run(models, [&](double share) { report(from + share * (to - from)); });
        keep_agreeing(all);
        return all;
    }

    bool better_with(const Anisotropy& anisotropy, const CurveFit& fit) const {
        const PredictionErrors without = points_.errors(Covariance(variogram_of(fit, {})));
        const PredictionErrors with =
            points_.errors(Covariance(variogram_of(stretched(fit, anisotropy), anisotropy)));
        return square_of_->surely_less(with.errors, without.errors);
    }

    /// By all the points, among the best by a subset of them. Of equally good ones one without a
    /// rough structure, and of these the one that fits the experimental values best.
    VariogramCandidate last_choice(std::vector<VariogramCandidate> all,
                                   const Anisotropy& anisotropy) const {
        std::ranges::stable_sort(all, {}, &VariogramCandidate::square);
        const double enough = kNearlyBest * all.front().square;
        while (all.size() > 1 && (all.size() > kFinalists || all.back().square > enough))
            all.pop_back();
        double least = std::numeric_limits<double>::infinity();
        for (VariogramCandidate& candidate : all) {
            const Covariance covariance(variogram_of(candidate.fit, anisotropy));
            candidate.square = (*square_of_)(points_.errors(covariance).errors);
            least = std::min(least, candidate.square);
        }
        const auto rank = [](const VariogramCandidate& candidate) {
            return std::pair(candidate.fit.curve.rough_share > 0, candidate.fit.misfit);
        };
        const VariogramCandidate* best = nullptr;
        for (const VariogramCandidate& candidate : all) {
            if (candidate.square > kAsGood * least) continue;
            if (best == nullptr || rank(candidate) < rank(*best)) best = &candidate;
        }
        return *best;
    }

    /// Scales ranges and sill so that as many errors lie within two deviations as should. The range
    /// scales variances near points, hardly changes the estimates and leaves the sill that of far
    /// pairs; the sill does the rest.
    void make_honest(FittedVariogram& out, double square) const {
        Variogram& variogram = out.variogram;
        const bool drifts = options_.drift != Drift::kConstant;
        std::optional<LeaveOneOut> fewer;
        if (drifts) {
            fewer.emplace(all_, points_.neighbors(), kPointsLeftOutOfDrift, buffer_, execution_);
        }
        const LeaveOneOut& points = drifts ? *fewer : points_;
        const auto errors_with = [&](const Variogram& v) {
            return points.errors(Covariance(v), options_.drift);
        };
        const PredictionErrors errors = errors_with(variogram);
        if (drifts) square = (*square_of_)(errors.errors);
        double scale = honest_sill(errors) / variogram.sill;
        if (!(scale > 0) || !std::isfinite(scale)) return;
        // As much of what the errors ask for as so many of them justify.
        const auto count = static_cast<double>(errors.errors.size());
        const double left_undone = elementary::pow(scale, kFewPoints / (count + kFewPoints));
        scale /= left_undone;
        const double power = growth(variogram, out.experimental.lags.front());
        const double longest = std::max(variogram.range, extent(variogram.anisotropy));
        double reach = 1;  // share of the step that would do it all
        for (int step = 0; step < 4 && std::abs(elementary::log(scale)) > 0.05; ++step) {
            const double times =
                std::min(std::clamp(elementary::pow(scale, -reach / power), 0.5, 2.0),
                         std::max(longest / variogram.range, 1.0));
            Variogram moved = variogram;
            moved.range *= times;
            for (NestedStructure& nested : moved.further)
                nested.range *= times;
            const PredictionErrors with_moved = errors_with(moved);
            const double with_range = honest_sill(with_moved) / moved.sill / left_undone;
            if (!(std::abs(elementary::log(with_range)) < std::abs(elementary::log(scale))) ||
                (*square_of_)(with_moved.errors) > kHardlyWorse * square) {
                reach /= 2;
                continue;
            }
            variogram = moved;
            scale = with_range;
        }
        multiply_sills(variogram, std::max(scale, kLeastScale));
    }

    /// The kriging variance grows as this power of short distances; that of a sum of structures as
    /// those do that contribute most at this distance.
    static double growth(const Variogram& variogram, double distance) {
        double open = 0, powers = 0;
        for (const NestedStructure& nested : variogram.structures()) {
            const double power = growth(nested.model);
            const double term = nested.sill * elementary::pow(distance / nested.range, power);
            open += term;
            powers += term * power;
        }
        return open > 0 && std::isfinite(powers) ? powers / open : growth(variogram.model);
    }

    static double growth(VariogramModel model) {
        switch (model) {
            case VariogramModel::kSpherical:
            case VariogramModel::kExponential:
                return 1;
            case VariogramModel::kCubic:
            case VariogramModel::kMatern32:
                return 3;  // of the kriging variance; gamma itself grows as the square
            case VariogramModel::kMatern52:
                return 5;
            case VariogramModel::kGaussian:
            case VariogramModel::kWave:
                return 8;
        }
        return 1;
    }

    const ManyPoints& all_;
    const FitOptions& options_;
    Execution execution_;
    double buffer_;
    LeaveOneOut points_, few_;  // all that are left out, and those that search
    std::optional<CappedSquare> square_of_;
};

/// For points that show no variation, or are too few to show any.
Variogram plain_variogram(const ManyPoints& all, const ExperimentalVariogram& e,
                          const Anisotropy& anisotropy) {
    const double largest = std::max(1.0, all.largest_value());
    const double length = all.diagonal(IsotropicSpace(anisotropy));
    Variogram variogram;
    variogram.anisotropy = anisotropy;
    variogram.range = length > 0 ? length : 1;
    const double shown = e.gamma.empty() ? 0 : *std::max_element(e.gamma.begin(), e.gamma.end());
    variogram.sill = std::max(shown, 1e-12 * largest * largest);
    return variogram;
}

}  // namespace

FittedVariogram fit_variogram(std::span<const std::array<double, 3>> points,
                              const Anisotropy& fixed_anisotropy, const FitOptions& options,
                              const Execution& execution) {
    const Anisotropy anisotropy = options.finds_anisotropy ? Anisotropy{} : fixed_anisotropy;
    check_anisotropy(anisotropy);
    if (options.neighbors < 1) {
        throw InputError("option", "a variogram is fitted with at least one neighbor");
    }
    ManyPoints all(points, options.are_apart);
    // Kriging the residuals with the drift gives the same errors as kriging the values.
    if (options.drift != Drift::kConstant) all.take_drift_out(options.drift);
    FittedVariogram out;
    out.experimental = experimental_variogram(all, anisotropy, execution.progress);
    const ExperimentalVariogram& e = out.experimental;
    out.variogram = plain_variogram(all, e, anisotropy);
    const bool varies = !e.gamma.empty() && *std::max_element(e.gamma.begin(), e.gamma.end()) >
                                                1e-12 * out.variogram.sill;
    const bool has_dips = !options.dips.positions.empty();
    if (fits_by_likelihood(all.size(), has_dips, options.has_bounds, options.error) &&
        (varies || has_dips)) {
        const auto likeliest = likeliest_variogram(points, anisotropy, options, execution.progress);
        if (likeliest) {
            out.variogram = *likeliest;
            return out;
        }
    }
    if (all.size() < 3 || e.lags.size() < 2 || !varies) return out;
    ModelSelection(all, options, execution).make(out);
    return out;
}

}  // namespace realmodel::interpolation
