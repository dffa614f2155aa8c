// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "interpolation/drift_basis.hpp"
#include "interpolation/kriging/covariance.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

namespace {

// Of a datum, given others, of the sill: with less they decide it. Under a Gaussian model, which is
// much smoother than the others, draws of heights are sums of large numbers then that cancel.
constexpr double kLeastVariance = 1e-9, kLeastOfGaussian = 1e-5;
constexpr double kShortest = 0.1, kLongest = 20;  // ranges, of the extent of the data
constexpr int kRanges = 18;
constexpr double kLeastTerm = 1e-4;  // of a term of the drift that others do not explain
constexpr double kRatios[] = {2, 4, 8};
constexpr double kAzimuthStep = 15;
constexpr double kMostAnisotropic = 20;
constexpr double kNuggets[] = {0.001, 0.01, 0.05, 0.2};                      // of the sill
constexpr double kThicknesses[] = {1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5};  // of the sill
constexpr double kOfAnisotropy = 2, kOfNugget = 2;  // gains of the logarithm, at least
constexpr std::size_t kFewestFree = 8;              // data that show an anisotropy or a nugget
constexpr double kLittle = 1e-3;                    // gains that end the refinement

/// Whether all variances of data, given those before them, are as large as `least`.
bool is_stable(const Eigen::LLT<Eigen::MatrixXd>& factor, double least) {
    if (factor.info() != Eigen::Success) return false;
    const double root = factor.matrixLLT().diagonal().minCoeff();
    return root * root > least;
}

/// The terms of a drift, whitened by the factor of the covariance of the data.
class WhitenedDrift {
public:
    WhitenedDrift(Eigen::MatrixXd terms, const Eigen::LLT<Eigen::MatrixXd>& lower)
        : terms_(std::move(terms)) {
        const Eigen::MatrixXd plain = terms_;
        lower.matrixL().solveInPlace(terms_);
        gram_.compute(terms_.transpose() * terms_);
        const Eigen::LLT<Eigen::MatrixXd> of_plain(plain.transpose() * plain);
        const double root = std::sqrt(static_cast<double>(plain.rows()));
        is_determined_ = gram_.info() == Eigen::Success && of_plain.info() == Eigen::Success &&
                         of_plain.matrixLLT().diagonal().minCoeff() > kLeastTerm * root;
    }

    /// Whether the data distinguish the terms.
    bool is_determined() const { return is_determined_; }
    const Eigen::MatrixXd& terms() const { return terms_; }
    Eigen::VectorXd coefficients(const Eigen::VectorXd& values) const {
        return gram_.solve(terms_.transpose() * values);
    }
    /// Half the logarithm of |F^T C^-1 F|.
    double log_determinant() const {
        double sum = 0;
        for (Eigen::Index k = 0; k < terms_.cols(); ++k)
            sum += elementary::log(gram_.matrixLLT()(k, k));
        return sum;
    }

private:
    Eigen::MatrixXd terms_;
    Eigen::LLT<Eigen::MatrixXd> gram_;
    bool is_determined_ = false;
};

}  // namespace

Likelihood::Likelihood(std::span<const std::array<double, 3>> points, const Dips& dips, Drift drift,
                       const Sheets& sheets)
    : points_(prepare_points(points, sheets.of_points)),
      spacing_(dips.baseline),
      drift_(drift),
      sheet_count_(sheets.variances.size()),
      column_of_(sheet_count_, -1) {
    check_dips(dips);
    const std::size_t count = points_.local.size();
    const std::size_t most = count < kMostData ? (kMostData - count) / 2 : 0;
    for (const std::int32_t dip : even_part(dips.positions.size(), most)) {
        dips_.push_back(dips.positions[dip]);
        slopes_.push_back(dips.slopes[dip]);
        if (has_sheets()) of_dips_.push_back(sheets.of_dips[dip]);
    }
    Position low = points_.local[0], high = low;
    const auto add = [&](const Position& position) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], position[axis]);
            high[axis] = std::max(high[axis], position[axis]);
        }
    };
    std::for_each(points_.local.begin(), points_.local.end(), add);
    for (const Position& dip : dips_)
        add(points_.to_local(dip));
    const double x = high[0] - low[0], y = high[1] - low[1];
    diagonal_ = std::sqrt(x * x + y * y);
    std::int32_t constants = 0;
    for (const std::int32_t sheet : points_.sheets)
        column_of_[sheet] = 0;
    for (std::int32_t& column : column_of_)
        column = column < 0 ? -1 : constants++;
    const std::size_t data = count + 2 * dips_.size();
    const std::size_t terms = static_cast<std::size_t>(drift_terms(drift)) - 1 +
                              (has_sheets() ? static_cast<std::size_t>(constants) : 1);
    free_ = data > terms ? data - terms : 0;
}

Eigen::MatrixXd Likelihood::drift_of(const LinearData& data) const {
    std::vector<Position> positions;
    const auto count = static_cast<std::int32_t>(data.size());
    for (std::int32_t i = 0; i < count; ++i)
        positions.push_back(data.position(i));
    const DriftFrame frame(positions, drift_);
    const Eigen::Index terms = drift_terms(drift_);
    const Eigen::Index constants =
        has_sheets() ? 1 + *std::max_element(column_of_.begin(), column_of_.end()) : 1;
    Eigen::MatrixXd drift = Eigen::MatrixXd::Zero(count, constants + terms - 1);
    for (std::int32_t i = 0; i < count; ++i) {
        const DriftFrame::Terms row = data.terms(i, frame);
        const Eigen::Index column = has_sheets() ? column_of_[data.sheet(i)] : 0;
        if (column >= 0) drift(i, column) = row(0);
        drift.row(i).tail(terms - 1) = row.tail(terms - 1);
    }
    return drift;
}

std::optional<Likelihood::Found> Likelihood::of(const Shape& shape) const {
    const Variogram& field = shape.variogram;
    Sheets sheets{
        points_.sheets, of_dips_, {}, {field.model, field.range, 1, 0, field.anisotropy, {}}};
    std::vector<double> variances;
    for (std::size_t sheet = 0; sheet < sheet_count_; ++sheet)
        variances.push_back(static_cast<double>(sheet) * shape.thickness);
    sheets.variances = variances;
    const Covariance covariance(field, sheets);
    const double baseline = dips_.empty() ? 1 : dip_baseline(field, spacing_);
    std::vector<std::array<double, 2>> scales;
    for (std::size_t sheet = 0; sheet == 0 || sheet < sheet_count_; ++sheet) {
        scales.push_back(covariance.scales_over(baseline, static_cast<std::int32_t>(sheet)));
        if (!dips_.empty() && !(scales.back()[0] > 0 && scales.back()[1] > 0)) return std::nullopt;
    }
    const LinearData data(points_, {dips_, slopes_, baseline, 0}, scales, covariance.units(),
                          of_dips_);
    const auto count = static_cast<Eigen::Index>(data.size());
    Eigen::MatrixXd matrix(count, count), drift = drift_of(data);
    Eigen::VectorXd values(count);
    for (std::int32_t i = 0; i < count; ++i) {
        for (std::int32_t j = 0; j < i; ++j)
            matrix(i, j) = data.between(i, j, covariance);
        matrix(i, i) = 1;
        values(i) = data.value(i, points_.values[0]);
    }
    const Eigen::LLT<Eigen::MatrixXd> lower(matrix);
    const bool is_gaussian = field.model == VariogramModel::kGaussian;
    if (!is_stable(lower, is_gaussian ? kLeastOfGaussian : kLeastVariance)) return std::nullopt;
    lower.matrixL().solveInPlace(values);
    const WhitenedDrift whitened(std::move(drift), lower);
    if (!whitened.is_determined()) return std::nullopt;
    const Eigen::VectorXd coefficients = whitened.coefficients(values);
    values -= whitened.terms() * coefficients;
    values -= whitened.terms() * whitened.coefficients(values);
    double sum = -whitened.log_determinant();
    for (Eigen::Index i = 0; i < count; ++i)
        sum -= elementary::log(lower.matrixLLT()(i, i));
    // what scales heights and differences scales their density, too
    for (std::int32_t i = 0; i < count; ++i) {
        const double scale = data.is_point(i) ? 1 : data.difference(i).scale * baseline;
        sum += elementary::log(scale / data.unit(data.sheet(i)));
    }
    const auto degrees = static_cast<double>(free_);
    const double sill = values.squaredNorm() / degrees;
    if (!(sill > 0) || !std::isfinite(sill)) return std::nullopt;
    Found found{sum - 0.5 * degrees * elementary::log(sill), sill, {}};
    for (const std::int32_t column : column_of_)
        found.constants.push_back(column < 0 ? 0 : coefficients(column));
    return found;
}

namespace {

class LikelihoodSearch {
public:
    using Shape = Likelihood::Shape;

    LikelihoodSearch(const Likelihood& likelihood, Progress* progress)
        : likelihood_(likelihood),
          progress_(progress),
          thickness_(likelihood.has_sheets() ? kThicknesses[2] : 0) {}

    /// Whether a shape is more likely than the best by more than so much; then it is the best.
    bool attempt(const Shape& shape, double gain = 0) {
        if (progress_ != nullptr) progress_->check();
        const std::optional<Likelihood::Found> found = likelihood_.of(shape);
        if (!found || (best_ && !(found->logarithm > best_->logarithm + gain))) return false;
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
        if (!likelihood_.has_sheets()) return;
        const Variogram plain = shape_.variogram;
        for (const double thickness : kThicknesses)
            attempt({plain, thickness});
        thickness_ = shape_.thickness;
    }

    void anisotropies(std::span<const VariogramModel> models) {
        LikelihoodSearch with(likelihood_, progress_);
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
        if (with.best_->logarithm > best_->logarithm + kOfAnisotropy) *this = with;
    }

    void nuggets() {
        const Shape plain = shape_;
        const double needed = best_->logarithm + kOfNugget;
        for (const double nugget : kNuggets) {
            Shape shape = plain;
            shape.variogram.nugget = nugget;
            attempt(shape, std::max(needed - best_->logarithm, 0.0));
        }
    }

    /// By steps that get shorter.
    void refine(bool turns) {
        double step = 0.35;
        for (int round = 0; round < 24 && step > 0.02; ++round) {
            const double before = best_->logarithm;
            for (const double up : {1.0, -1.0}) {
                Shape shape = shape_;
                shape.variogram.range = std::clamp(
                    shape.variogram.range * elementary::exp(up * step),
                    kShortest * likelihood_.diagonal() / 4, kLongest * likelihood_.diagonal());
                attempt(shape);
                if (likelihood_.has_sheets()) {
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
            if (best_->logarithm - before < kLittle) step /= 2;
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

    Variogram variogram() const {
        Variogram out = shape_.variogram;
        out.sill = best_->sill;
        out.nugget = shape_.variogram.nugget * best_->sill;
        return out;
    }

    FittedSheets sheets() const { return {variogram(), shape_.thickness, best_->constants, {}}; }

    /// Of sheets whose variogram is given.
    FittedSheets sheets_of(const Variogram& given) const {
        return {given, shape_.thickness * best_->sill / given.sill, best_->constants, {}};
    }

    /// All steps, for a surface or for sheets.
    void run(std::span<const VariogramModel> models, const Anisotropy& given,
             bool finds_anisotropy) {
        ranges_of(models, given);
        if (!has_found()) return;
        thicknesses();
        refine(false);
        thickness_ = shape_.thickness;
        const bool is_rich = likelihood_.free() >= kFewestFree;
        if (is_rich && finds_anisotropy) anisotropies(models);
        if (is_rich) nuggets();
    }

private:
    double range(int k) const {
        return likelihood_.diagonal() * kShortest *
               elementary::pow(kLongest / kShortest, static_cast<double>(k) / (kRanges - 1));
    }

    Likelihood likelihood_;
    Progress* progress_;
    std::optional<Likelihood::Found> best_;
    Shape shape_;
    double thickness_ = 0;  // of sheets, from which a search begins
};

constexpr std::array kSmooth{VariogramModel::kGaussian, VariogramModel::kCubic,
                             VariogramModel::kMatern52, VariogramModel::kMatern32};

std::span<const VariogramModel> models_for(const FitOptions& options) {
    if (options.dips.positions.empty()) return kAllVariogramModels;
    return kSmooth;
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
    LikelihoodSearch search(likelihood, progress);
    search.run(models_for(options), given, options.finds_anisotropy);
    if (!search.has_found()) return std::nullopt;
    return search.variogram();
}

std::optional<FittedSheets> fit_sheets(std::span<const std::array<double, 3>> points,
                                       const Sheets& sheets, const Anisotropy& anisotropy,
                                       const FitOptions& options,
                                       const std::optional<Variogram>& given,
                                       const Execution& execution) {
    check_anisotropy(anisotropy);
    check_sheets(sheets, points.size(), options.dips.positions.size());
    if (points.size() > kMostPointsOfSheets) return std::nullopt;
    const Likelihood likelihood(points, options.dips, options.drift, sheets);
    if (!is_enough(likelihood)) return std::nullopt;
    LikelihoodSearch search(likelihood, execution.progress);
    if (given) {
        search.thicknesses_of(*given);
    } else {
        search.run(models_for(options), anisotropy, options.finds_anisotropy);
    }
    if (!search.has_found()) return std::nullopt;
    FittedSheets found = given ? search.sheets_of(*given) : search.sheets();
    const std::vector<std::array<double, 3>> leveled = one_surface(points, sheets, found.constants);
    if (!given && found.thickness <= kThicknesses[0]) {
        // thicknesses that do not vary say nothing of how heights do
        const auto as_one = likeliest_variogram(leveled, anisotropy, options, execution.progress);
        if (as_one) found.variogram = *as_one;
    }
    found.experimental = experimental_variogram(leveled, found.variogram.anisotropy);
    return found;
}

}  // namespace realmodel::interpolation
