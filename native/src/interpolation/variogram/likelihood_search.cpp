// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

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
constexpr double kNuggets[] = {0.001, 0.01, 0.05, 0.2};                      // of the sill
constexpr double kThicknesses[] = {1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5};  // of the sill
constexpr double kOfAnisotropy = 2, kOfNugget = 2;  // gains of the logarithm, at least
constexpr std::size_t kFewestFree = 8;              // data that show an anisotropy or a nugget
constexpr double kLittle = 1e-3;                    // gains that end the refinement

class LikelihoodSearch {
public:
    using Shape = Likelihood::Shape;

    /// @param parts  data that do not depend on one another; they need not be of one place
    LikelihoodSearch(std::vector<Likelihood> parts, Progress* progress)
        : parts_(std::move(parts)),
          progress_(progress),
          has_sheets_(parts_.front().has_sheets()),
          thickness_(has_sheets_ ? kThicknesses[2] : 0) {
        for (const Likelihood& part : parts_) {
            diagonal_ = std::max(diagonal_, part.diagonal());
            free_ += part.free();
        }
    }

    /// Whether a shape is more likely than the best by more than so much; then it is the best.
    bool attempt(const Shape& shape, double gain = 0) {
        if (progress_ != nullptr) progress_->check();
        const std::optional<Likelihood::Found> found = together(shape);
        if (!found || (best_ && !(found->logarithm() > best_->logarithm() + gain))) return false;
        best_ = found;
        shape_ = shape;
        return true;
    }

    void ranges_of(std::span<const VariogramModel> models, const Anisotropy& anisotropy) {
        for (const VariogramModel model : models) {
            for (int k = 0; k < kRanges; ++k)
                attempt({{model, range(k), 1, 0, anisotropy, {}}, thickness_});
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
        LikelihoodSearch with(parts_, progress_);
        with.thickness_ = thickness_;
        for (const double ratio : kRatios) {
            for (double azimuth = 0; azimuth < 180; azimuth += kAzimuthStep) {
                for (int k = 0; k < kRanges; k += 2) {
                    const VariogramModel model = shape_.variogram.model;
                    with.attempt({{model, range(k), 1, 0, {ratio, azimuth}, {}}, thickness_});
                }
            }
        }
        if (!with.best_) return;
        with.ranges_of(models, with.shape_.variogram.anisotropy);
        with.refine(true);
        if (with.best_->logarithm() > best_->logarithm() + kOfAnisotropy) *this = with;
    }

    void nuggets() {
        const Shape plain = shape_;
        const double needed = best_->logarithm() + kOfNugget;
        for (const double nugget : kNuggets) {
            Shape shape = plain;
            shape.variogram.nugget = nugget;
            attempt(shape, std::max(needed - best_->logarithm(), 0.0));
        }
    }

    /// By steps that get shorter.
    void refine(bool turns) {
        double step = 0.35;
        for (int round = 0; round < 24 && step > 0.02; ++round) {
            const double before = best_->logarithm();
            for (const double up : {1.0, -1.0}) {
                Shape shape = shape_;
                shape.variogram.range =
                    std::clamp(shape.variogram.range * elementary::exp(up * step),
                               kShortest * diagonal_ / 4, kLongest * diagonal_);
                attempt(shape);
                if (has_sheets_) {
                    shape = shape_;
                    shape.thickness = std::clamp(shape.thickness * elementary::exp(4 * up * step),
                                                 kThicknesses[0], *(std::end(kThicknesses) - 1));
                    attempt(shape);
                }
                if (!turns) continue;
                shape = shape_;
                Anisotropy& anisotropy = shape.variogram.anisotropy;
                anisotropy.ratio = std::clamp(anisotropy.ratio * elementary::exp(up * step), 1.0,
                                              kMostAnisotropic);
                attempt(shape);
                shape = shape_;
                anisotropy.azimuth += up * step * kAzimuthStep;
                if (anisotropy.azimuth < 0) anisotropy.azimuth += 180;
                if (anisotropy.azimuth >= 180) anisotropy.azimuth -= 180;
                attempt(shape);
            }
            if (best_->logarithm() - before < kLittle) step /= 2;
        }
    }

    void thicknesses_of(const Variogram& given) {
        Variogram shape = given;
        shape.sill = 1;
        shape.nugget /= given.sill;
        for (NestedStructure& part : shape.further)
            part.sill /= given.sill;
        for (const double thickness : kThicknesses)
            attempt({shape, thickness});
    }

    bool has_found() const { return best_.has_value(); }

    /// Of some of the data alone, with the shape that was found for all.
    double sill_of(const Likelihood& part) const {
        const std::optional<Likelihood::Found> own =
            part.free() < kFewestFree ? std::nullopt : part.of(shape_);
        return own && own->squares > 0 ? own->sill() : best_->sill();
    }

    Variogram variogram() const {
        Variogram out = shape_.variogram;
        out.sill = best_->sill();
        out.nugget = shape_.variogram.nugget * best_->sill();
        return out;
    }

    FittedSheets sheets() const { return {variogram(), shape_.thickness, best_->constants, {}}; }

    /// Of sheets whose variogram is given.
    FittedSheets sheets_of(const Variogram& given) const {
        return {given, shape_.thickness * best_->sill() / given.sill, best_->constants, {}};
    }

    /// All steps, for a surface or for sheets.
    void run(std::span<const VariogramModel> models, const Anisotropy& given,
             bool finds_anisotropy) {
        ranges_of(models, given);
        if (!has_found()) return;
        thicknesses();
        refine(false);
        thickness_ = shape_.thickness;
        const bool is_rich = free_ >= kFewestFree;
        if (is_rich && finds_anisotropy) anisotropies(models);
        if (is_rich) nuggets();
    }

private:
    std::optional<Likelihood::Found> together(const Shape& shape) const {
        std::optional<Likelihood::Found> all;
        for (const Likelihood& part : parts_) {
            std::optional<Likelihood::Found> found = part.of(shape);
            if (!found) return std::nullopt;
            if (all) {
                all->add(*found);
            } else {
                all = std::move(found);
            }
        }
        if (!(all->squares > 0)) return std::nullopt;
        return all;
    }

    double range(int k) const {
        return diagonal_ * kShortest *
               elementary::pow(kLongest / kShortest, static_cast<double>(k) / (kRanges - 1));
    }

    std::vector<Likelihood> parts_;
    Progress* progress_;
    bool has_sheets_;
    double diagonal_ = 0;   // the longest of the parts
    std::size_t free_ = 0;  // of all of them
    std::optional<Likelihood::Found> best_;
    Shape shape_;
    double thickness_ = 0;  // of sheets, from which a search begins
};

constexpr std::array kSmooth{VariogramModel::kGaussian, VariogramModel::kCubic,
                             VariogramModel::kMatern52, VariogramModel::kMatern32};

std::span<const VariogramModel> models_for(bool has_dips) {
    if (has_dips) return kSmooth;
    return kAllVariogramModels;
}

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
                                             const Anisotropy& given, const FitOptions& options,
                                             Progress* progress) {
    const Likelihood likelihood(points, options.dips, options.drift);
    if (!is_enough(likelihood)) return std::nullopt;
    LikelihoodSearch search({likelihood}, progress);
    search.run(models_for(!options.dips.positions.empty()), given, options.finds_anisotropy);
    if (!search.has_found()) return std::nullopt;
    return search.variogram();
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
    LikelihoodSearch search(std::move(enough), execution.progress);
    search.run(models_for(has_dips), anisotropy, options.finds_anisotropy);
    if (!search.has_found()) return {};
    const Variogram shared = search.variogram();
    std::vector<FittedVariogram> found;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
        Variogram own = shared;
        own.sill = search.sill_of(all[k]);
        own.nugget *= own.sill / shared.sill;
        found.push_back({own, experimental_variogram(surfaces[k].points, own.anisotropy)});
    }
    return found;
}

std::optional<FittedSheets> fit_sheets(std::span<const std::array<double, 3>> points,
                                       const Sheets& sheets, const Anisotropy& anisotropy,
                                       const FitOptions& options,
                                       const std::optional<Variogram>& given,
                                       const Execution& execution) {
    check_anisotropy(anisotropy);
    check_sheets(sheets, points.size(), options.dips.positions.size());
    const Likelihood likelihood(points, options.dips, options.drift, sheets);
    if (!is_enough(likelihood)) return std::nullopt;
    LikelihoodSearch search({likelihood}, execution.progress);
    if (given) {
        search.thicknesses_of(*given);
    } else {
        search.run(models_for(!options.dips.positions.empty()), anisotropy,
                   options.finds_anisotropy);
    }
    if (!search.has_found()) return std::nullopt;
    FittedSheets found = given ? search.sheets_of(*given) : search.sheets();
    const std::vector<std::array<double, 3>> leveled = one_surface(points, sheets, found.constants);
    if (!given && found.thickness <= kThicknesses[0]) {
        // thicknesses that do not vary say nothing of how heights do
        const auto as_one = likeliest_variogram(leveled, anisotropy, options, execution.progress);
        if (as_one) found.variogram = *as_one;
    }
    found.points = likelihood.points();
    found.experimental = experimental_variogram(leveled, found.variogram.anisotropy);
    return found;
}

}  // namespace realmodel::interpolation
