// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/sheet_fit.hpp"
#include "realmodel/interpolation/sheets.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {

/// How likely heights and slopes together are with a variogram: restricted maximum likelihood,
/// which knows nothing of the drift (Kitanidis 1983, "Statistical estimation of polynomial
/// generalized covariance functions", Water Resources Research 19; Chiles and Delfiner 2012,
/// section 2.6.3). Each sheet of several has a constant of its own. Of many points, and of many
/// dips, a fixed, even subset counts.
class Likelihood {
public:
    /// Points, and points and both slopes of the dips together, that are taken.
    static constexpr std::size_t kMostPoints = kMostPointsOfSheets, kMostData = 200;

    /// @param dips    their baseline is the mean spacing of points and dips
    /// @param sheets  of points and dips; their variances say how many there are
    Likelihood(std::span<const std::array<double, 3>> points, const Dips& dips, Drift drift,
               const Sheets& sheets = {});

    /// Of points and dips.
    double diagonal() const { return diagonal_; }
    /// Heights and slopes, less the terms of the drift.
    std::size_t free() const { return free_; }
    bool has_sheets() const { return sheet_count_ > 0; }
    /// So many count.
    std::size_t points() const { return points_.local.size(); }

    /// What is asked how likely it is.
    struct CovarianceModel {
        Variogram variogram;   ///< with the sill 1, of which the nugget is a share
        double thickness = 0;  ///< the variance of each thickness between sheets
    };
    struct LikelihoodTerms {
        double density;                 ///< its logarithm with the sill 1, but for the squares
        double squares;                 ///< of what shape and drift do not explain
        std::size_t free;               ///< as of free()
        std::vector<double> constants;  ///< of each sheet, above the first point; 0 without points
        double least_sill = 0;          ///< no sill below it is possible

        /// With which the data are most likely.
        double sill() const;
        /// How likely they are with this sill.
        double logarithm() const;
        /// Of data that do not depend on these, with the same sill.
        void add(const LikelihoodTerms& other);
    };
    /// @return none where the data are one another's consequences with it, up to rounding
    std::optional<LikelihoodTerms> of(const CovarianceModel& shape) const;

private:
    /// The terms of the drift: a row for each datum. Those of one surface are its frame's; sheets
    /// have a constant each in the place of the first.
    Eigen::MatrixXd drift_of(const LinearData& data) const;

    DataPoints points_;
    double base_;  // of heights: the first point's
    std::vector<PlanPosition> dips_, slopes_;
    std::vector<std::int32_t> of_dips_;
    double spacing_, diagonal_ = 0;
    Drift drift_;
    std::size_t sheet_count_;
    std::vector<std::int32_t> column_of_;  // of the constant of each sheet; without points -1
    std::size_t free_ = 0;
};

/// The variogram with which a few points, and dips, are most likely: of all models, of the smooth
/// ones where there are dips. Ranges from a part of the extent of the data to several times that,
/// an anisotropy where it is asked for, and a nugget are searched on a grid and refined; anisotropy
/// and nugget where they are more likely by more than their number of parameters explains (Akaike
/// 1974).
/// @return none where there is none, or the data are too few
std::optional<Variogram> likeliest_variogram(std::span<const std::array<double, 3>> points,
                                             const Anisotropy& anisotropy,
                                             const FitOptions& options, Progress* progress);

}  // namespace realmodel::interpolation
