// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "interpolation/variogram/experimental_variogram.hpp"
#include "interpolation/variogram/likelihood.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kShortest = 0.1, kLongest = 20;  // ranges, of the extent of the data
constexpr int kRanges = 18;
constexpr double kRatios[] = {2, 4, 8};
constexpr double kAzimuthStep = 15;
constexpr double kMostAnisotropic = 20;
constexpr double kNuggets[] = {0.001, 0.01, 0.05, 0.2};  // of the sill
constexpr double kLikelyNuggets[] = {0, 0.1, 0.3};
constexpr double kThicknesses[] = {1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5};  // of the sill
// Of the sill, where the nugget is at least that of known errors.
constexpr double kNuggetsOfErrors[] = {1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1}, kMostOfErrors = 0.5;
constexpr double kOfNugget = 2;            // a gain of the logarithm, at least
constexpr std::size_t kFewestFree = 8;     // data that show an anisotropy or a nugget
constexpr std::size_t kFewestOfWave = 24;  // data that show a wave
constexpr double kOfWave = 10;             // as above: many waves are tried
constexpr double kShortestWave = 0.15, kLongestWave = 1;  // of the extent of the data
constexpr int kWaves = 11;
constexpr double kWaveRange = 2;  // to begin with, of the extent
constexpr double kWaveShares[] = {0.02, 0.5}, kMostOfWave = 0.999;
constexpr double kLittle = 1e-3;  // gains that end the refinement

constexpr std::array kSmooth{VariogramModel::kGaussian, VariogramModel::kCubic,
                             VariogramModel::kMatern52, VariogramModel::kMatern32};

/// Bounds that count become data beside the points, where a Gaussian model, which is much smoother
/// than the others, has hardly any freedom left: heights are sums of large numbers then.
std::vector<VariogramModel> models_for(bool has_dips, bool has_bounds) {
    std::vector<VariogramModel> models(kRisingModels.begin(), kRisingModels.end());
    if (has_dips) models.assign(kSmooth.begin(), kSmooth.end());
    if (has_bounds) std::erase(models, VariogramModel::kGaussian);
    return models;
}

/// By how much the logarithm has to be larger with `more` parameters than with `few` of them, as so
/// many data show: few data may look like anything by chance (the criterion of Akaike, corrected
/// for few data: C. M. Hurvich and C.-L. Tsai 1989, "Regression and time series model selection in
/// small samples").
double needed_gain(double few, double more, std::size_t data) {
    const auto penalty = [count = static_cast<double>(data)](double parameters) {
        return parameters + parameters * (parameters + 1) / (count - parameters - 1);
    };
    return penalty(more) - penalty(few);
}

/// Step k of so many from one length to another, whose ratios are equal.
double between(double first, double last, int k, int steps) {
    return first * elementary::pow(last / first, static_cast<double>(k) / (steps - 1));
}

class LikelihoodSearch {
public:
    using CovarianceModel = Likelihood::CovarianceModel;

    /// @param likelihoods  data that do not depend on one another; they need not be of one place
    /// @param error  the variance of the errors of their heights: a nugget is no less
    LikelihoodSearch(std::vector<Likelihood> likelihoods, double error, Progress* progress)
        : likelihoods_(std::move(likelihoods)),
          error_(error),
          progress_(progress),
          has_sheets_(likelihoods_.front().has_sheets()),
          thickness_(has_sheets_ ? kThicknesses[2] : 0) {
        for (const Likelihood& likelihood : likelihoods_) {
            diagonal_ = std::max(diagonal_, likelihood.diagonal());
            free_ += likelihood.free();
        }
    }

    /// Whether a shape is more likely than the best by more than so much; then it is the best.
    bool attempt(const CovarianceModel& shape, double gain = 0) {
        if (progress_ != nullptr) progress_->check();
        const std::optional<Likelihood::LikelihoodTerms> terms = together(shape);
        if (!terms || (best_ && !(terms->logarithm() > best_->logarithm() + gain))) return false;
        best_ = terms;
        shape_ = shape;
        return true;
    }

    void ranges_of(std::span<const VariogramModel> models, const Anisotropy& anisotropy) {
        for (const VariogramModel model : models) {
            for (int k = 0; k < kRanges; ++k) {
                for (const double nugget : nuggets_to_begin_with())
                    attempt({{model, range(k), 1, nugget, anisotropy, {}}, thickness_});
            }
        }
    }

    /// Of sheets the variance of their thicknesses, beside the best shape.
    void thicknesses() {
        if (!has_sheets_) return;
        const Variogram plain = shape_.variogram;
        for (const double thickness : kThicknesses)
            attempt({plain, thickness});
        thickness_ = shape_.thickness;
    }

    void anisotropies(std::span<const VariogramModel> models) {
        LikelihoodSearch with(likelihoods_, error_, progress_);
        const double nugget = shape_.variogram.nugget;
        with.thickness_ = thickness_;
        for (const double ratio : kRatios) {
            for (double azimuth = 0; azimuth < 180; azimuth += kAzimuthStep) {
                for (int k = 0; k < kRanges; k += 2) {
                    const VariogramModel model = shape_.variogram.model;
                    with.attempt({{model, range(k), 1, nugget, {ratio, azimuth}, {}}, thickness_});
                }
            }
        }
        if (!with.best_) return;
        with.ranges_of(models, with.shape_.variogram.anisotropy);
        with.refine(true);
        const double gain = needed_gain(2, 4, free_);  // sill and range; ratio and azimuth, too
        if (with.best_->logarithm() > best_->logarithm() + gain) *this = with;
    }

    void nuggets() {
        const CovarianceModel plain = shape_;
        const double needed = best_->logarithm() + kOfNugget;
        for (const double nugget : kNuggets) {
            CovarianceModel shape = plain;
            shape.variogram.nugget = nugget;
            attempt(shape, std::max(needed - best_->logarithm(), 0.0));
        }
    }

    /// A wave and what it leaves, in no direction more than in others, where they make the data far
    /// more likely than the best shape: folds that come again and again.
    void waves() {
        LikelihoodSearch with(likelihoods_, error_, progress_);
        const double nugget = shape_.variogram.nugget, range = kWaveRange * diagonal_;
        const Variogram rest{VariogramModel::kMatern52, shape_.variogram.range, 1, nugget, {}, {}};
        for (double azimuth = 0; azimuth < 180; azimuth += kAzimuthStep) {
            for (int k = 0; k < kWaves; ++k) {
                const double length = diagonal_ * between(kShortestWave, kLongestWave, k, kWaves);
                for (const double share : kWaveShares) {
                    CovarianceModel shape{rest, shape_.thickness};
                    shape.variogram.further = {{VariogramModel::kWave,
                                                range,
                                                share * (1 - nugget),
                                                {range / length, azimuth}}};
                    with.attempt(shape);
                }
            }
        }
        if (!with.best_ || !(with.best_->logarithm() > best_->logarithm())) return;
        with.refine_wave();
        if (with.best_->logarithm() > best_->logarithm() + kOfWave) *this = with;
    }

    /// As refine, the wave and the range of the first structure.
    void refine_wave() {
        in_shorter_steps(0.01, [&](double by) {
            attempt_changed([&](CovarianceModel& shape) { stretch(shape.variogram.range, by); });
            attempt_changed([&](CovarianceModel& shape) {  // the length alone
                shape.variogram.further[0].anisotropy.ratio *= elementary::exp(by / 4);
            });
            attempt_changed(
                [&](CovarianceModel& shape) { turn(shape.variogram.further[0].anisotropy, by); });
            attempt_changed([&](CovarianceModel& shape) {  // the range alone
                NestedStructure& wave = shape.variogram.further[0];
                const double before = wave.range;
                stretch(wave.range, 2 * by);
                wave.anisotropy.ratio *= wave.range / before;
            });
            attempt_changed([&](CovarianceModel& shape) {  // odds of the share
                const double whole = 1 - shape.variogram.nugget;
                double& sill = shape.variogram.further[0].sill;
                const double odds = sill / (whole - sill) * elementary::exp(4 * by);
                sill = whole * std::min(odds / (1 + odds), kMostOfWave);
            });
        });
    }

    /// By steps that get shorter.
    void refine(bool turns) {
        in_shorter_steps(0.02, [&](double by) {
            attempt_changed([&](CovarianceModel& shape) { stretch(shape.variogram.range, by); });
            if (has_sheets_) {
                attempt_changed([&](CovarianceModel& shape) {
                    shape.thickness = std::clamp(shape.thickness * elementary::exp(4 * by),
                                                 kThicknesses[0], *(std::end(kThicknesses) - 1));
                });
            }
            if (error_ > 0) {
                attempt_changed([&](CovarianceModel& shape) {
                    double& nugget = shape.variogram.nugget;
                    nugget = std::clamp(nugget * elementary::exp(4 * by), kNuggetsOfErrors[0],
                                        kMostOfErrors);
                });
            }
            if (!turns) return;
            attempt_changed([&](CovarianceModel& shape) {
                double& ratio = shape.variogram.anisotropy.ratio;
                ratio = std::clamp(ratio * elementary::exp(by), 1.0, kMostAnisotropic);
            });
            attempt_changed([&](CovarianceModel& shape) { turn(shape.variogram.anisotropy, by); });
        });
    }

    void thicknesses_of(const Variogram& shared) {
        Variogram shape = shared;
        multiply_sills(shape, 1 / shared.sill);
        for (const double thickness : kThicknesses)
            attempt({shape, thickness});
    }

    bool has_result() const { return best_.has_value(); }

    /// Of some of the data alone, with the shape that was found for all.
    double sill_of(const Likelihood& likelihood) const {
        std::optional<Likelihood::LikelihoodTerms> terms =
            likelihood.free() < kFewestFree ? std::nullopt : likelihood.of(shape_);
        if (!terms || !(terms->squares > 0)) return best_->sill();
        terms->least_sill = best_->least_sill;
        return terms->sill();
    }

    Variogram variogram() const {
        Variogram out = shape_.variogram;
        multiply_sills(out, best_->sill());
        return out;
    }

    FittedSheets sheets() const { return {variogram(), shape_.thickness, best_->constants, {}}; }

    /// Of sheets whose variogram is given.
    FittedSheets sheets_of(const Variogram& shared) const {
        return {shared, shape_.thickness * best_->sill() / shared.sill, best_->constants, {}};
    }

    /// All steps, for a surface or for sheets.
    void run(bool has_dips, const Anisotropy& anisotropy, const FitOptions& options) {
        const std::vector<VariogramModel> models = models_for(has_dips, options.has_bounds);
        ranges_of(models, anisotropy);
        if (!has_result()) return;
        thicknesses();
        refine(false);
        thickness_ = shape_.thickness;
        const bool is_rich = free_ >= kFewestFree;
        if (is_rich && options.finds_anisotropy) anisotropies(models);
        if (is_rich && error_ == 0) nuggets();
        // limbs of folds are seen in dips; points alone may look like waves by chance
        if (has_dips && options.finds_anisotropy && free_ >= kFewestOfWave) waves();
    }

private:
    std::optional<Likelihood::LikelihoodTerms> together(const CovarianceModel& shape) const {
        std::optional<Likelihood::LikelihoodTerms> all;
        for (const Likelihood& likelihood : likelihoods_) {
            std::optional<Likelihood::LikelihoodTerms> terms = likelihood.of(shape);
            if (!terms) return std::nullopt;
            if (all) {
                all->add(*terms);
            } else {
                all = std::move(terms);
            }
        }
        if (!(all->squares > 0)) return std::nullopt;
        if (error_ > 0) all->least_sill = error_ / shape.variogram.nugget;
        return all;
    }

    /// Calls attempt_step with steps up and down, which get shorter where these gain little.
    template <class Attempt>
    void in_shorter_steps(double last, const Attempt& attempt_step) {
        double step = 0.35;
        for (int round = 0; round < 24 && step > last; ++round) {
            const double before = best_->logarithm();
            attempt_step(step);
            attempt_step(-step);
            if (best_->logarithm() - before < kLittle) step /= 2;
        }
    }

    template <class Change>
    void attempt_changed(const Change& change) {
        CovarianceModel shape = shape_;
        change(shape);
        attempt(shape);
    }

    void stretch(double& range, double by) const {
        range = std::clamp(range * elementary::exp(by), kShortest * diagonal_ / 4,
                           kLongest * diagonal_);
    }

    static void turn(Anisotropy& anisotropy, double steps) {
        anisotropy.azimuth += steps * kAzimuthStep;
        if (anisotropy.azimuth < 0) anisotropy.azimuth += 180;
        if (anisotropy.azimuth >= 180) anisotropy.azimuth -= 180;
    }

    double range(int k) const { return diagonal_ * between(kShortest, kLongest, k, kRanges); }

    std::span<const double> nuggets_to_begin_with() const {
        static constexpr double kNone[] = {0};
        if (error_ > 0) return kNuggetsOfErrors;
        return kNone;
    }

    std::vector<Likelihood> likelihoods_;
    double error_;
    Progress* progress_;
    bool has_sheets_;
    double diagonal_ = 0;   // the longest of the parts
    std::size_t free_ = 0;  // of all of them
    std::optional<Likelihood::LikelihoodTerms> best_;
    CovarianceModel shape_;
    double thickness_ = 0;  // of sheets, from which a search begins
};

/// One point at each position of sheets, less the constant of its sheet.
std::vector<std::array<double, 3>> one_surface(std::span<const std::array<double, 3>> points,
                                               const Sheets& sheets,
                                               const std::vector<double>& constants) {
    std::vector<std::array<double, 3>> leveled(points.begin(), points.end());
    for (std::size_t i = 0; i < leveled.size(); ++i)
        leveled[i][2] -= constants[sheets.of_points[i]];
    std::sort(leveled.begin(), leveled.end());
    const auto are_at_one = [](const auto& a, const auto& b) {
        return a[0] == b[0] && a[1] == b[1];
    };
    leveled.erase(std::unique(leveled.begin(), leveled.end(), are_at_one), leveled.end());
    return leveled;
}

bool is_enough(const Likelihood& likelihood) {
    return likelihood.free() >= 2 && likelihood.diagonal() > 0;
}

}  // namespace

std::optional<Variogram> likeliest_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& anisotropy,
                                             const FitOptions& options, Progress* progress) {
    const Likelihood likelihood(points, options.dips, options.drift);
    if (!is_enough(likelihood)) return std::nullopt;
    LikelihoodSearch search({likelihood}, options.error, progress);
    search.run(!options.dips.positions.empty(), anisotropy, options);
    if (!search.has_result()) return std::nullopt;
    return search.variogram();
}

std::vector<LikelyVariogram> likely_variograms(std::span<const std::array<double, 3>> points,
                                               const Anisotropy& anisotropy,
                                               const FitOptions& options,
                                               const Execution& execution) {
    check_anisotropy(anisotropy);
    const Likelihood likelihood(points, options.dips, options.drift);
    std::vector<LikelyVariogram> out;
    if (!is_enough(likelihood)) return out;
    for (const VariogramModel model :
         models_for(!options.dips.positions.empty(), options.has_bounds)) {
        for (int k = 0; k < kRanges; ++k) {
            if (execution.progress != nullptr) execution.progress->check();
            const double range = likelihood.diagonal() * between(kShortest, kLongest, k, kRanges);
            for (const double nugget : kLikelyNuggets) {
                const Variogram shape{model, range, 1, nugget, anisotropy, {}};
                const std::optional<Likelihood::LikelihoodTerms> terms = likelihood.of({shape});
                if (!terms || !(terms->squares > 0)) continue;
                const double free = static_cast<double>(terms->free);
                const double density = terms->density - free / 2 * elementary::log(terms->squares);
                out.push_back({shape, density, terms->squares, terms->free});
            }
        }
    }
    return out;
}

std::vector<FittedVariogram> fit_alike(std::span<const SurfaceData> surfaces,
                                       const Anisotropy& anisotropy, const FitOptions& options,
                                       const Execution& execution) {
    check_anisotropy(anisotropy);
    std::vector<Likelihood> all, enough;
    bool has_dips = false;
    for (const SurfaceData& surface : surfaces) {
        all.emplace_back(surface.points, surface.dips, options.drift);
        if (is_enough(all.back())) enough.push_back(all.back());
        has_dips |= !surface.dips.positions.empty();
    }
    if (enough.empty()) return {};
    LikelihoodSearch search(std::move(enough), options.error, execution.progress);
    search.run(has_dips, anisotropy, options);
    if (!search.has_result()) return {};
    const Variogram shared = search.variogram();
    std::vector<FittedVariogram> fits;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
        Variogram scaled = shared;
        multiply_sills(scaled, search.sill_of(all[k]) / shared.sill);
        fits.push_back({scaled, experimental_variogram(surfaces[k].points, scaled.anisotropy)});
    }
    return fits;
}

std::optional<FittedSheets> fit_sheets(std::span<const std::array<double, 3>> points,
                                       const Sheets& sheets, const Anisotropy& anisotropy,
                                       const FitOptions& options,
                                       const std::optional<Variogram>& fixed_variogram,
                                       const Execution& execution) {
    check_anisotropy(anisotropy);
    check_sheets(sheets, points.size(), options.dips.positions.size());
    const Likelihood likelihood(points, options.dips, options.drift, sheets);
    if (!is_enough(likelihood)) return std::nullopt;
    LikelihoodSearch search({likelihood}, options.error, execution.progress);
    if (fixed_variogram) {
        search.thicknesses_of(*fixed_variogram);
    } else {
        search.run(!options.dips.positions.empty(), anisotropy, options);
    }
    if (!search.has_result()) return std::nullopt;
    FittedSheets fit = fixed_variogram ? search.sheets_of(*fixed_variogram) : search.sheets();
    const std::vector<std::array<double, 3>> leveled = one_surface(points, sheets, fit.constants);
    if (!fixed_variogram && fit.thickness <= kThicknesses[0]) {
        // thicknesses that do not vary say nothing of how heights do
        const auto as_one = likeliest_variogram(leveled, anisotropy, options, execution.progress);
        if (as_one) fit.variogram = *as_one;
    }
    fit.points = likelihood.points();
    fit.experimental = experimental_variogram(leveled, fit.variogram.anisotropy);
    return fit;
}

}  // namespace realmodel::interpolation
