// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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
constexpr double kRatios[] = {2, 4, 8};
constexpr double kAzimuthStep = 15;
constexpr double kMostAnisotropic = 20;
constexpr double kNuggets[] = {0.001, 0.01, 0.05, 0.2};  // of the sill
constexpr double kOfAnisotropy = 2, kOfNugget = 2;       // gains of the logarithm, at least
constexpr std::size_t kFewestFree = 8;                   // data that show an anisotropy or a nugget
constexpr double kLittle = 1e-3;                         // gains that end the refinement

/// Whether all variances of data, given those before them, are as large as `least`.
bool is_stable(const Eigen::LLT<Eigen::MatrixXd>& factor, double least) {
    if (factor.info() != Eigen::Success) return false;
    const double root = factor.matrixLLT().diagonal().minCoeff();
    return root * root > least;
}

}  // namespace

Likelihood::Likelihood(std::span<const std::array<double, 3>> points, const Dips& dips, Drift drift)
    : points_(prepare_points(points)), spacing_(dips.baseline), drift_(drift) {
    check_dips(dips);
    const std::size_t count = points_.local.size();
    const std::size_t most = count < kMostData ? (kMostData - count) / 2 : 0;
    for (const std::int32_t dip : even_part(dips.positions.size(), most)) {
        dips_.push_back(dips.positions[dip]);
        slopes_.push_back(dips.slopes[dip]);
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
    const std::size_t data = count + 2 * dips_.size();
    const auto terms = static_cast<std::size_t>(drift_terms(drift));
    free_ = data > terms ? data - terms : 0;
}

std::optional<Likelihood::Found> Likelihood::of(const Variogram& shape) const {
    const Covariance covariance(shape);
    const double baseline = dips_.empty() ? 1 : dip_baseline(shape, spacing_);
    const std::array<double, 2> scales = covariance.scales_over(baseline);
    if (!dips_.empty() && !(scales[0] > 0 && scales[1] > 0)) return std::nullopt;
    const LinearData data(points_, {dips_, slopes_, baseline, 0}, scales);
    const auto count = static_cast<Eigen::Index>(data.size());
    std::vector<Position> positions;
    Eigen::MatrixXd matrix(count, count), drift(count, drift_terms(drift_));
    Eigen::VectorXd values(count);
    for (std::int32_t i = 0; i < count; ++i)
        positions.push_back(data.position(i));
    const DriftFrame frame(positions, drift_);
    for (std::int32_t i = 0; i < count; ++i) {
        for (std::int32_t j = 0; j < i; ++j)
            matrix(i, j) = data.between(i, j, covariance);
        matrix(i, i) = 1;
        drift.row(i) = data.terms(i, frame);
        values(i) = data.value(i, points_.values[0]);
    }
    const Eigen::LLT<Eigen::MatrixXd> lower(matrix);
    const bool is_gaussian = shape.model == VariogramModel::kGaussian;
    if (!is_stable(lower, is_gaussian ? kLeastOfGaussian : kLeastVariance)) return std::nullopt;
    lower.matrixL().solveInPlace(values);
    const Eigen::MatrixXd plain = drift;
    lower.matrixL().solveInPlace(drift);
    DriftBasis basis;
    basis.make(plain, drift);
    if (basis.size() < drift.cols()) return std::nullopt;
    values -= basis.expand(basis.project(values));
    double sum = 0;
    for (Eigen::Index i = 0; i < count; ++i)
        sum -= elementary::log(lower.matrixLLT()(i, i));
    // |F^T C^-1 F| by its own factor; what scales the differences scales their density, too
    const Eigen::MatrixXd gram = drift.transpose() * drift;
    const Eigen::LLT<Eigen::MatrixXd> of_drift(gram);
    for (Eigen::Index k = 0; k < gram.rows(); ++k)
        sum -= elementary::log(of_drift.matrixLLT()(k, k));
    for (const double scale : scales)
        sum += static_cast<double>(dips_.size()) * elementary::log(scale * baseline);
    const auto degrees = static_cast<double>(free_);
    const double sill = values.squaredNorm() / degrees;
    if (!(sill > 0) || !std::isfinite(sill)) return std::nullopt;
    return Found{sum - 0.5 * degrees * elementary::log(sill), sill};
}

namespace {

class LikelihoodSearch {
public:
    LikelihoodSearch(const Likelihood& likelihood, Progress* progress)
        : likelihood_(likelihood), progress_(progress) {}

    /// Whether a shape is more likely than the best by more than so much; then it is the best.
    bool attempt(const Variogram& shape, double gain = 0) {
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
                attempt({model, range(k), 1, 0, anisotropy, {}});
        }
    }

    void anisotropies(std::span<const VariogramModel> models) {
        LikelihoodSearch with(likelihood_, progress_);
        for (const double ratio : kRatios) {
            for (double azimuth = 0; azimuth < 180; azimuth += kAzimuthStep) {
                for (int k = 0; k < kRanges; k += 2)
                    with.attempt({shape_.model, range(k), 1, 0, {ratio, azimuth}, {}});
            }
        }
        if (!with.best_) return;
        with.ranges_of(models, with.shape_.anisotropy);
        with.refine(true);
        if (with.best_->logarithm > best_->logarithm + kOfAnisotropy) *this = with;
    }

    void nuggets() {
        const Variogram plain = shape_;
        const double needed = best_->logarithm + kOfNugget;
        for (const double nugget : kNuggets) {
            Variogram shape = plain;
            shape.nugget = nugget;
            attempt(shape, std::max(needed - best_->logarithm, 0.0));
        }
    }

    /// By steps that get shorter.
    void refine(bool turns) {
        double step = 0.35;
        for (int round = 0; round < 24 && step > 0.02; ++round) {
            const double before = best_->logarithm;
            for (const double up : {1.0, -1.0}) {
                Variogram shape = shape_;
                shape.range = std::clamp(shape.range * elementary::exp(up * step),
                                         kShortest * likelihood_.diagonal() / 4,
                                         kLongest * likelihood_.diagonal());
                attempt(shape);
                if (!turns) continue;
                shape = shape_;
                shape.anisotropy.ratio = std::clamp(
                    shape.anisotropy.ratio * elementary::exp(up * step), 1.0, kMostAnisotropic);
                attempt(shape);
                shape = shape_;
                shape.anisotropy.azimuth += up * step * kAzimuthStep;
                if (shape.anisotropy.azimuth < 0) shape.anisotropy.azimuth += 180;
                if (shape.anisotropy.azimuth >= 180) shape.anisotropy.azimuth -= 180;
                attempt(shape);
            }
            if (best_->logarithm - before < kLittle) step /= 2;
        }
    }

    std::optional<Variogram> found() const {
        if (!best_) return std::nullopt;
        Variogram out = shape_;
        out.sill = best_->sill;
        out.nugget = shape_.nugget * best_->sill;
        return out;
    }

private:
    double range(int k) const {
        return likelihood_.diagonal() * kShortest *
               elementary::pow(kLongest / kShortest, static_cast<double>(k) / (kRanges - 1));
    }

    Likelihood likelihood_;
    Progress* progress_;
    std::optional<Likelihood::Found> best_;
    Variogram shape_;
};

}  // namespace

std::optional<Variogram> likeliest_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& given, const FitOptions& options,
                                             Progress* progress) {
    const Likelihood likelihood(points, options.dips, options.drift);
    if (likelihood.free() < 2 || !(likelihood.diagonal() > 0)) return std::nullopt;
    constexpr std::array kSmooth{VariogramModel::kGaussian, VariogramModel::kCubic,
                                 VariogramModel::kMatern52, VariogramModel::kMatern32};
    const std::span<const VariogramModel> models =
        options.dips.positions.empty() ? std::span<const VariogramModel>(kAllVariogramModels)
                                       : std::span<const VariogramModel>(kSmooth);
    LikelihoodSearch search(likelihood, progress);
    search.ranges_of(models, given);
    if (!search.found()) return std::nullopt;
    search.refine(false);
    const bool is_rich = likelihood.free() >= kFewestFree;
    if (is_rich && options.finds_anisotropy) search.anisotropies(models);
    if (is_rich) search.nuggets();
    return search.found();
}

}  // namespace realmodel::interpolation
