// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/likelihood.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "interpolation/drift_basis.hpp"
#include "interpolation/kriging/covariance.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/base/elementary.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::interpolation {

namespace {

// Of a datum, given others, of the sill: with less they decide it. Under a Gaussian model, which is
// much smoother than the others, draws of heights are sums of large numbers then that cancel.
constexpr double kLeastVariance = 1e-9, kLeastOfGaussian = 1e-5;
constexpr double kLeastTerm = 1e-4;  // of a term of the drift that others do not explain

/// Of many points on sheets a fixed subset: of each sheet as many, but for those that have fewer,
/// at positions that are spread evenly and are the same where several sheets have points at one.
/// @param sheets  that each is on; empty: there is one
std::vector<std::int32_t> spread_subset(std::span<const std::array<double, 3>> points,
                                        std::span<const std::int32_t> sheets, std::size_t most) {
    std::vector<std::int32_t> subset(points.size());
    std::iota(subset.begin(), subset.end(), 0);
    const auto plan = transformed(points, [](const auto& p) { return PlanPosition{p[0], p[1]}; });
    // Whole numbers with their bits reversed: the first ones are spread evenly, however many.
    std::vector<std::uint32_t> turn(points.size());
    std::uint32_t rank = 0;
    const PlanPosition* before = nullptr;
    for (const std::uint32_t i : spatial::along_hilbert_curve(plan)) {
        if (before != nullptr && *before != plan[i]) ++rank;
        before = &plan[i];
        for (unsigned bit = 0; bit < 32; ++bit)
            turn[i] |= (rank >> bit & 1U) << (31 - bit);
    }
    const auto sheet = [&](std::int32_t i) { return sheets.empty() ? 0 : sheets[i]; };
    std::ranges::sort(subset, {}, [&](std::int32_t i) { return std::tuple(sheet(i), turn[i], i); });
    std::vector<std::size_t> sizes;  // of the sheets with points
    for (const auto of_sheet : groups_of(subset, sheet))
        sizes.push_back(of_sheet.size());
    std::sort(sizes.begin(), sizes.end());
    std::size_t left = most, quota = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        quota = std::max<std::size_t>(left / (sizes.size() - k), 1);
        left -= std::min(left, std::min(quota, sizes[k]));
    }
    std::vector<std::int32_t> numbers;
    for (const auto of_sheet : groups_of(subset, sheet)) {
        const auto first = of_sheet.first(std::min(of_sheet.size(), quota));
        numbers.insert(numbers.end(), first.begin(), first.end());
    }
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

/// A subset of points on sheets, as Likelihood takes them.
DataPoints some_points(std::span<const std::array<double, 3>> points,
                       std::span<const std::int32_t> sheets) {
    DataPoints all = prepare_points(points, sheets);
    if (points.size() <= Likelihood::kMostPoints) return all;
    const std::vector<std::int32_t> subset = spread_subset(points, sheets, Likelihood::kMostPoints);
    std::vector<std::int32_t> sheets_of_subset;
    if (!sheets.empty())
        sheets_of_subset = transformed(subset, [&](std::int32_t i) { return sheets[i]; });
    return prepare_points(transformed(subset, [&](std::int32_t i) { return points[i]; }),
                          sheets_of_subset);
}

/// Whether all variances of data, given those before them, are as large as `least`.
bool is_stable(const Eigen::LLT<Eigen::MatrixXd>& factor, double least) {
    if (factor.info() != Eigen::Success) return false;
    const double root = factor.matrixLLT().diagonal().minCoeff();
    return root * root > least;
}

}  // namespace

Likelihood::Likelihood(std::span<const std::array<double, 3>> points, const Dips& dips, Drift drift,
                       const Sheets& sheets)
    : points_(some_points(points, sheets.of_points)),
      base_(points[0][2]),
      spacing_(dips.baseline),
      drift_(drift),
      sheet_count_(sheets.variances.size()),
      column_of_(sheet_count_, -1) {
    check_dips(dips);
    const std::size_t count = points_.local.size();
    const std::size_t most = count < kMostData ? (kMostData - count) / 2 : 0;
    for (const std::int32_t dip : even_subset(dips.positions.size(), most)) {
        dips_.push_back(dips.positions[dip]);
        slopes_.push_back(dips.slopes[dip]);
        if (has_sheets()) of_dips_.push_back(sheets.of_dips[dip]);
    }
    spatial::PlanBox box = spatial::box_around(points_.local);
    for (const PlanPosition& dip : dips_) {
        const auto [x, y] = points_.to_local(dip);
        box = box.united({x, y, x, y});
    }
    diagonal_ = length(Vec2{box.width(), box.height()});

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
    std::vector<PlanPosition> positions;
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

double Likelihood::LikelihoodTerms::sill() const {
    return std::max(squares / static_cast<double>(free), least_sill);
}

double Likelihood::LikelihoodTerms::logarithm() const {
    const auto count = static_cast<double>(free);
    const bool is_likeliest = sill() == squares / count;
    const double beyond = is_likeliest ? 0 : squares / sill() - count;
    return density - 0.5 * (count * elementary::log(sill()) + beyond);
}

void Likelihood::LikelihoodTerms::add(const LikelihoodTerms& other) {
    density += other.density;
    squares += other.squares;
    free += other.free;
}

std::optional<Likelihood::LikelihoodTerms> Likelihood::of(const CovarianceModel& shape) const {
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
        values(i) = data.value(i, base_);
    }
    const Eigen::LLT<Eigen::MatrixXd> lower(matrix);
    const bool is_gaussian = field.model == VariogramModel::kGaussian;
    if (!is_stable(lower, is_gaussian ? kLeastOfGaussian : kLeastVariance)) return std::nullopt;
    const Eigen::Index terms = drift.cols();
    const Eigen::HouseholderQR<Eigen::MatrixXd> plain(drift);
    const double least = kLeastTerm * std::sqrt(static_cast<double>(count));
    if (!(plain.matrixQR().diagonal().cwiseAbs().minCoeff() > least)) return std::nullopt;
    lower.matrixL().solveInPlace(values);
    lower.matrixL().solveInPlace(drift);
    const Eigen::HouseholderQR<Eigen::MatrixXd> whitened(drift);
    values.applyOnTheLeft(whitened.householderQ().adjoint());
    const auto upper = whitened.matrixQR().topRows(terms).triangularView<Eigen::Upper>();
    const Eigen::VectorXd coefficients = upper.solve(values.head(terms));
    double sum = 0;  // with half the logarithm of |F^T C^-1 F|
    for (Eigen::Index k = 0; k < terms; ++k)
        sum -= elementary::log(std::abs(whitened.matrixQR()(k, k)));
    for (Eigen::Index i = 0; i < count; ++i)
        sum -= elementary::log(lower.matrixLLT()(i, i));
    // what scales heights and differences scales their density, too
    for (std::int32_t i = 0; i < count; ++i) {
        const double scale = data.is_point(i) ? 1 : data.difference(i).scale * baseline;
        sum += elementary::log(scale / data.unit(data.sheet(i)));
    }
    LikelihoodTerms likelihood{sum, values.tail(count - terms).squaredNorm(), free_, {}, 0};
    if (!std::isfinite(likelihood.squares)) return std::nullopt;
    for (const std::int32_t column : column_of_)
        likelihood.constants.push_back(column < 0 ? 0 : coefficients(column));
    return likelihood;
}

}  // namespace realmodel::interpolation
