// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fields/functional.hpp"
#include "fields/known_data.hpp"
#include "fields/spline.hpp"
#include "fields/spline_constraints.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/field.hpp"

namespace realmodel::fields {

inline constexpr AxisRatios kIsotropic{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 1, 1}};

/// Scales space by the ratios along the axes.
Map3 map_of(const AxisRatios& anisotropy);

/// What kind of random function data are most likely to be of.
struct Likely {
    AxisRatios anisotropy = kIsotropic;
    Errors errors;
    int order = 3;               ///< of the derivatives that are least: see Kernel
    double lift = 1;             ///< of further coordinates
    std::vector<Vec3> throws{};  ///< by how much places move for each unit of each of these
    bool is_even = false;        ///< beds keep their thickness: see EvenSteepness

    Smoothness smoothness() const { return {map_of(anisotropy), errors, order, lift, throws}; }
};

/// How likely what is known is with each of some kinds: Spline::log_likelihood, -inf where it has
/// none.
std::vector<double> log_likelihoods(std::span<const Functional> known,
                                    std::span<const Likely> kinds, double error,
                                    const Execution& execution);

/// The anisotropy, the errors of measurement and the scale of further coordinates under which what
/// is known is most likely, with the third order. The anisotropy is along the fold axis, to which
/// the normals are most nearly perpendicular, or where they show none along the best of some
/// directions; then along a direction across it. Where faults give further coordinates, it is also
/// sought by how much places on one side of each have been moved along it.
/// @param faults  their normals
/// @param error  of values, as of Spline::log_likelihood
Likely most_likely(std::span<const Functional> known, std::span<const Vec3> normals,
                   std::span<const Vec3> faults, double error, const Execution& execution);

/// The same, with an anisotropy along any directions. It takes about three times as long.
Likely most_likely_anywhere(std::span<const Functional> known, const Likely& likely, double error,
                            const Execution& execution);

/// The same with the fifth order, whose ratios are one over ranges: `likely` where that is
/// likelier.
Likely most_likely_smooth(std::span<const Functional> known, const Likely& likely, double error,
                          const Execution& execution);

/// How well kinds of fields predict data that are left out. Likelihoods of a field's values do not
/// say so: their size is free, so that a field is likely that hardly changes where data are, or
/// folds back between them. Here contacts are missed by distances, and dips by angles.
class CrossValidation {
public:
    /// Takes a sample of the data. What lies in one place is left out together.
    /// @param gaps  as of KnownData::fixed()
    CrossValidation(const KnownData& known, std::span<const double> gaps);

    /// Of each kind the negative logarithm of the likelihood of what is missed, less a constant, by
    /// Laplace's distribution, as a few data may be missed by far. The order of surfaces and
    /// polarities hold in what is left.
    std::vector<double> costs(std::span<const Likely> kinds, const Execution& execution) const;

private:
    /// Sums.
    struct Missed {
        double distances = 0, angles = 0;
    };

    Missed missed(const Likely& kind, int fold) const;
    /// A function of a kind through rows, and the inequalities that it has to meet.
    Spline solved(const Likely& kind, std::vector<Functional> rows,
                  ActiveInequalities& active) const;
    std::vector<Functional> rows_without(int fold, int order) const;
    std::vector<Inequality> inequalities_without(int fold, int order) const;

    const KnownData& known_;
    std::vector<double> gaps_;
    std::vector<std::size_t> contacts_, dips_;
    std::vector<int> contact_folds_, dip_folds_;
    EvenSteepness even_;
    double steepness_ = 1;  // in the mean, from surface to surface
};

/// The kind of field that predicts data best that are left out.
struct LikelyField {
    Likely likely;
    std::vector<double> gaps;          ///< differences of the levels; none: they are free
    std::vector<double> plain_shares;  ///< as of Field
};

/// Levels are free, unless the field would be far steeper between some of them than between
/// others: it is smoothest where it is flat, so that rough surfaces can draw their levels together.
/// @param is_even  whether beds keep their thickness; none: if it predicts data better
/// @throws InputError wrong_order: a surface lies on the wrong side of the next
LikelyField likely_field(const KnownData& known, std::optional<bool> is_even,
                         const Execution& execution);

}  // namespace realmodel::fields
