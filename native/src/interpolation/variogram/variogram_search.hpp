// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/variogram/experimental_variogram.hpp"
#include "interpolation/variogram/leave_one_out.hpp"

namespace realmodel::interpolation {

/// A variogram, and how well kriging with it predicts points that are left out.
struct VariogramCandidate {
    CurveFit fit;
    double sill = 0;    ///< with which the variances are honest
    double square = 0;  ///< mean square of the errors

    /// Whether errors and experimental values ask for sills that have nothing to do with each
    /// other.
    bool contradicts() const;
};

/// Removes those that contradict, unless all do.
void keep_agreeing(std::vector<VariogramCandidate>& candidates);

/// The one of the least mean square.
/// @param candidates  at least one
const VariogramCandidate& best_of(const std::vector<VariogramCandidate>& candidates);

/// Models that predict points nearly as well as the best.
std::vector<VariogramModel> hopeful_models(const std::vector<VariogramCandidate>& candidates);

/// The search for the variogram with which points that are left out are predicted best: curves
/// fitted to experimental values, and others around them.
class VariogramSearch {
public:
    /// @param longest    no range is tried beyond it, unless the experimental values ask for it
    /// @param square_of  measures the errors; made from the best fit where there is none yet
    VariogramSearch(const LeaveOneOut& points, const ExperimentalVariogram& e,
                    const Anisotropy& anisotropy, double longest,
                    std::optional<CappedSquare>& square_of)
        : points_(points),
          e_(e),
          anisotropy_(anisotropy),
          longest_(longest),
          square_of_(square_of) {}

    /// All candidates of these models; empty where none fits at all.
    /// @param report  gets the share that is done; throws to stop
    std::vector<VariogramCandidate> run(std::span<const VariogramModel> models,
                                        const std::function<void(double)>& report);

    /// Changes the ranges, the rougher structure and the nugget of a variogram by steps, as long as
    /// the prediction improves by more than chance.
    /// @param start  its mean square is that of these points
    VariogramCandidate refined(const VariogramCandidate& start) const;

private:
    void start(std::span<const VariogramModel> models);
    std::optional<CurveFit> with_sill(const VariogramCurve& curve, double nugget) const;
    VariogramCandidate judged(const CurveFit& fit, const PredictionErrors& predictions) const;
    std::optional<VariogramCandidate> candidate(const VariogramCurve& curve, double nugget) const;
    void attempt(const VariogramCurve& curve, std::span<const double> nuggets,
                 std::span<const double> rough_shares, double longest);
    void attempt(const VariogramCurve& curve, double nugget, double longest) {
        attempt(curve, {&nugget, 1}, {&curve.rough_share, 1}, longest);
    }
    void vary(const VariogramCandidate& start);
    void roughen(VariogramModel model);
    const VariogramCandidate* best_with(VariogramModel model) const;

    const LeaveOneOut& points_;
    const ExperimentalVariogram& e_;
    const Anisotropy& anisotropy_;
    double longest_;
    std::optional<CappedSquare>& square_of_;
    std::vector<VariogramCandidate> all_;
};

/// A fit's range under an anisotropy: the area within it stays the same.
CurveFit stretched(CurveFit fit, const Anisotropy& anisotropy);

/// Ratio and azimuth of the least mean square with this fit, stretched; of ratio 1 where none is
/// better than none. Ratios up to four are tried: beyond, the nearest points in plan would no more
/// be those that matter most.
Anisotropy find_anisotropy(const LeaveOneOut& points, const CurveFit& fit,
                           const CappedSquare& square_of);

/// Whether positions spread in two directions, so that an anisotropy shows.
bool spread_in_plan(const ManyPoints& points);

}  // namespace realmodel::interpolation
