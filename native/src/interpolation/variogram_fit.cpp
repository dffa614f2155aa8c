// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "interpolation/drift_basis.hpp"
#include "interpolation/experimental_variogram.hpp"
#include "interpolation/left_out_points.hpp"
#include "interpolation/weighted_fit.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t points_left_out = 10'000;
constexpr std::size_t points_left_out_of_drift = 1000;
constexpr double outlying = 20;      // deviations: errors beyond count as if there
constexpr double as_good = 1.004;    // of mean squares: RMS errors within 0.2 % tell nothing apart
constexpr double contradicting = 8;  // times: errors and experimental values ask for such sills
constexpr double hopeless = 2;       // times the best mean square: such a model is not looked into
// Of the experimental value at the shortest lag.
constexpr double nuggets_tried[] = {0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
constexpr double ranges_tried[] = {0.25, 0.5, 2, 4};  // times the range that fits the curve best
constexpr double within_two = 0.95;  // share of errors within two deviations where these are honest
constexpr double shown_by_few = 200;   // points: fewer tell less of how honest variances are than
                                       // pairs of them tell of the curve
constexpr double hardly_worse = 1.01;  // of mean squares, for the sake of honest variances
// A sill far below what distant pairs show would make variances far from points too small.
constexpr double least_scale = 0.25;

double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Mean squares of errors, of which a few may be of another kind (faults, mistakes in the data).
class Judge {
public:
    /// @param errors  of a variogram that is not bad: what is outlying is judged by them
    explicit Judge(const std::vector<double>& errors) {
        std::vector<double> sizes;
        double squares = 0;
        for (const double error : errors) {
            sizes.push_back(std::abs(error));
            squares += error * error;
        }
        const double deviation = 1.4826 * quantile(sizes, 0.5);
        const double limit =
            std::max(outlying * deviation, std::sqrt(squares / static_cast<double>(errors.size())));
        most_ = limit * limit;
    }
    double operator()(const std::vector<double>& errors) const {
        double sum = 0;
        for (const double error : errors)
            sum += std::min(error * error, most_);
        return sum / static_cast<double>(errors.size());
    }

private:
    double most_;
};

Variogram variogram_of(const CurveFit& fit, const Anisotropy& anisotropy) {
    return {fit.model, fit.range, fit.sill(), fit.nugget, anisotropy, {}};
}

bool usable(const CurveFit& fit) {
    return fit.sill() > 0 && std::isfinite(fit.sill()) && std::isfinite(fit.misfit);
}

/// Errors squared over variances in units of the sill, where 95 % of them are below four.
double honest_sill(const LeftOutErrors& told) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < told.errors.size(); ++i) {
        // Where neighbours nearly coincide the variance is rounding: it must not decide.
        const double variance = std::max(told.variances[i], 1e-9);
        ratios.push_back(told.errors[i] * told.errors[i] / variance);
    }
    return quantile(std::move(ratios), within_two) / 4;
}

/// The choice among models, ranges and nuggets by points left out.
class Choice {
public:
    Choice(const DataPoints& data, const ExperimentalVariogram& e, const Anisotropy& anisotropy,
           const FitOptions& options, Progress* progress)
        : data_(data),
          e_(e),
          anisotropy_(anisotropy),
          options_(options),
          progress_(progress),
          extent_(diagonal(isotropic_places(data, anisotropy))),
          points_(data, static_cast<std::size_t>(options.neighbours), points_left_out,
                  options.threads, progress) {}

    /// False where no model fits at all.
    bool make(FittedVariogram& out) {
        std::vector<Candidate> starts;
        for (const VariogramModel model : all_variogram_models) {
            for (const bool with_nugget : {true, false})
                consider(fit_curve(e_, model, with_nugget), starts);
            report(0.3 * static_cast<double>(starts.size()) / 12);
        }
        if (starts.empty()) return false;
        const Judge judge(best_start(starts).errors);
        double least = std::numeric_limits<double>::infinity();
        for (Candidate& start : starts) {
            start.square = judge(start.errors);
            least = std::min(least, start.square);
        }
        std::vector<Candidate> all;
        double done = 0;
        for (const VariogramModel model : all_variogram_models) {
            report(0.3 + 0.5 * done++ / all_variogram_models.size());
            search(model, starts, hopeless * least, judge, all);
        }
        for (Candidate& start : starts)
            all.push_back(std::move(start));
        // One with which errors and experimental values agree, if there is one.
        const auto last = std::partition(all.begin(), all.end(), [](const Candidate& candidate) {
            return !candidate.contradicts();
        });
        if (last != all.begin()) all.erase(last, all.end());
        least = std::numeric_limits<double>::infinity();
        for (const Candidate& candidate : all)
            least = std::min(least, candidate.square);
        // Of those that tell points equally well the one that fits the experimental values best.
        const Candidate* best = nullptr;
        for (const Candidate& candidate : all) {
            if (candidate.square > as_good * least) continue;
            if (best == nullptr || candidate.fit.misfit < best->fit.misfit) best = &candidate;
        }
        report(0.9);
        out.variogram = variogram_of(best->fit, anisotropy_);
        make_honest(out.variogram, best->square, judge);
        return true;
    }

private:
    struct Candidate {
        CurveFit fit;
        std::vector<double> errors;
        double sill = 0;  // of honest variances
        double square = 0;

        bool contradicts() const {
            return !(std::abs(std::log(sill / fit.sill())) < std::log(contradicting));
        }
    };

    void report(double share) const {
        if (progress_ == nullptr) return;
        progress_->report(share, "fitting the variogram");
        progress_->check();
    }

    LeftOutErrors told_by(const CurveFit& fit) const {
        return points_.told_by(Covariance(variogram_of(fit, anisotropy_)));
    }

    void consider(const CurveFit& fit, std::vector<Candidate>& into) const {
        if (!usable(fit)) return;
        LeftOutErrors told = told_by(fit);
        const double sill = honest_sill(told);
        into.push_back({fit, std::move(told.errors), sill});
    }

    static const Candidate& best_start(const std::vector<Candidate>& starts) {
        const auto median = [](const Candidate& candidate) {
            std::vector<double> sizes;
            for (const double error : candidate.errors)
                sizes.push_back(std::abs(error));
            return quantile(std::move(sizes), 0.5);
        };
        return *std::min_element(
            starts.begin(), starts.end(),
            [&](const Candidate& a, const Candidate& b) { return median(a) < median(b); });
    }

    /// Nuggets, then ranges, then nuggets again, about what fits the experimental values best.
    void search(VariogramModel model, const std::vector<Candidate>& starts, double enough,
                const Judge& judge, std::vector<Candidate>& all) const {
        const Candidate* start = nullptr;
        for (const Candidate& candidate : starts) {
            if (candidate.fit.model != model || candidate.square > enough) continue;
            if (start == nullptr || candidate.square < start->square) start = &candidate;
        }
        if (start == nullptr) return;
        CurveFit best = start->fit;
        double least = start->square;
        const auto attempt = [&](double range, double nugget) {
            if (range > std::max(start->fit.range, extent_)) return;
            const CurveFit fit = fit_sill(e_, model, range, nugget);
            if (!usable(fit) || fit.partial_sill <= 0) return;
            const LeftOutErrors told = told_by(fit);
            all.push_back({fit, {}, honest_sill(told), judge(told.errors)});
            if (all.back().square < least) {
                least = all.back().square;
                best = fit;
            }
        };
        for (const double share : nuggets_tried)
            attempt(start->fit.range, share * e_.gamma.front());
        const CurveFit with_nugget = best;
        for (const double times : ranges_tried)
            attempt(with_nugget.range * times, with_nugget.nugget);
        const CurveFit with_range = best;
        for (const double times : {0.3, 3.0}) {
            const double nugget =
                with_range.nugget > 0 ? with_range.nugget : 1e-3 * e_.gamma.front();
            attempt(with_range.range, nugget * times);
        }
    }

    /// Moves range and sill so that as many errors lie within two deviations as should. Near points
    /// the range does it, which hardly changes what is told, and the sill stays that of far pairs;
    /// what is left is the sill's to do.
    void make_honest(Variogram& variogram, double square, const Judge& judge) const {
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
        if (drifts) square = judge(errors.errors);
        double scale = honest_sill(errors) / variogram.sill;
        if (!(scale > 0) || !std::isfinite(scale)) return;
        // Of what the errors ask for, as much as so many of them are worth.
        const auto count = static_cast<double>(errors.errors.size());
        const double left_undone = std::pow(scale, shown_by_few / (count + shown_by_few));
        scale /= left_undone;
        const double power = growth(variogram.model);
        for (int step = 0; step < 3 && std::abs(std::log(scale)) > 0.05; ++step) {
            Variogram moved = variogram;
            moved.range *= std::clamp(std::pow(scale, -1 / power), 0.5, 2.0);
            moved.range = std::min(moved.range, std::max(variogram.range, extent_));
            LeftOutErrors with_moved = told(moved);
            const double with_range = honest_sill(with_moved) / moved.sill / left_undone;
            if (!(std::abs(std::log(with_range)) < std::abs(std::log(scale))) ||
                judge(with_moved.errors) > hardly_worse * square) {
                break;
            }
            variogram = moved;
            scale = with_range;
        }
        scale = std::max(scale, least_scale);
        variogram.sill *= scale;
        variogram.nugget *= scale;
    }

    /// gamma grows as this power of short distances.
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
    const ExperimentalVariogram& e_;
    const Anisotropy& anisotropy_;
    const FitOptions& options_;
    Progress* progress_;
    double extent_;  // of the points: no range is moved beyond it
    LeftOutPoints points_;
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
                              const Anisotropy& anisotropy, Progress* progress,
                              const FitOptions& options) {
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
    Choice(data, e, anisotropy, options, progress).make(out);
    return out;
}

}  // namespace realmodel::interpolation
