// SPDX-License-Identifier: GPL-3.0-or-later
// The search for the variogram with which points that are left out are told best. Private.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/variogram/capped_square.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/weighted_fit.hpp"

namespace realmodel::interpolation {

/// A variogram, and how well it tells points.
struct Candidate {
    CurveFit fit;
    double sill = 0;    ///< of honest variances
    double square = 0;  ///< mean, of the errors

    /// Whether errors and experimental values ask for sills that have nothing to do with each
    /// other.
    bool contradicts() const;
};

/// Without those that contradict, unless all do.
void keep_agreeing(std::vector<Candidate>& candidates);

/// The one of the least mean square. They are not empty.
const Candidate& best_of(const std::vector<Candidate>& candidates);

/// Models that tell points nearly as well as the best.
std::vector<VariogramModel> hopeful_models(const std::vector<Candidate>& candidates);

/// What changing the ranges, the rougher part and the nugget of a variogram by steps leads to, as
/// long as points are told better by more than chance.
/// @param start  its square is that of these points
Candidate refined(const Candidate& start, const LeftOutPoints& points,
                  const ExperimentalVariogram& e, const Anisotropy& anisotropy, double longest,
                  const Judge& judge);

/// Curves fitted to experimental values, and others about them.
class VariogramSearch {
public:
    /// @param longest  no range is tried beyond it, unless the experimental values ask for it
    /// @param report   told the share that is done; throws to stop
    VariogramSearch(const LeftOutPoints& points, const ExperimentalVariogram& e,
                    const Anisotropy& anisotropy, double longest,
                    std::function<void(double)> report)
        : points_(points),
          e_(e),
          anisotropy_(anisotropy),
          longest_(longest),
          report_(std::move(report)) {}

    /// All that was tried of these models; empty where none fits at all. judge: made of what is
    /// found where there is none yet.
    std::vector<Candidate> run(std::span<const VariogramModel> models, std::optional<Judge>& judge);

private:
    void start(std::span<const VariogramModel> models, std::optional<Judge>& judge);
    void attempt(const Curve& curve, double nugget, double longest);
    void vary(const Candidate& start);
    void roughen(VariogramModel model);
    const Candidate* best_with(VariogramModel model) const;

    const LeftOutPoints& points_;
    const ExperimentalVariogram& e_;
    const Anisotropy& anisotropy_;
    double longest_;
    std::function<void(double)> report_;
    const Judge* judge_ = nullptr;
    std::vector<Candidate> all_;
};

}  // namespace realmodel::interpolation
