// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fields/active_inequalities.hpp"
#include "fields/anisotropy.hpp"
#include "fields/even_steepness.hpp"
#include "fields/known_data.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::fields {

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

    Missed missed(const Likely& kind, int part) const;
    /// A function of a kind through rows, and the inequalities that it has to meet.
    Spline solved(const Likely& kind, std::vector<Functional> rows,
                  ActiveInequalities& active) const;
    std::vector<Functional> rows_without(int part, int order) const;
    std::vector<Inequality> inequalities_without(int part, int order) const;

    const KnownData& known_;
    std::vector<double> gaps_;
    std::vector<std::size_t> contacts_, dips_;
    std::vector<int> contact_parts_, dip_parts_;
    EvenSteepness even_;
    double steepness_ = 1;  // in the mean, from surface to surface
};

}  // namespace realmodel::fields
