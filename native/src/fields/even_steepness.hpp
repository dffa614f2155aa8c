// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fields/functional.hpp"
#include "fields/known_data.hpp"
#include "fields/spline.hpp"

namespace realmodel::fields {

/// Beds that keep their thickness around bends and beyond the data, as in parallel folds: at places
/// all over the lattice a field rises, along the gradient that it has, nearly as it does where the
/// same bed is known. Since both follow from the field, it is solved anew some times (with a
/// constant norm of the gradient: Laurent, Ailleres, Grose, Caumon, Jessell and Armit 2016,
/// "Implicit modeling of folds and overprinting deformation").
class EvenSteepness {
public:
    static constexpr int kRounds = 6;

    explicit EvenSteepness(const KnownData& known);

    /// Of each place the vector along which a field is to rise by 1; 0 where it has no gradient.
    std::vector<Vec3> directions(const Spline& spline) const;
    /// That it does so.
    /// @param directions  of all places
    /// @param variance  of its error, in units of the kernel
    std::vector<Functional> rows(std::span<const Vec3> directions, int order,
                                 double variance) const;
    /// The variance, in units of the kernel, of the error that is allowed. Infinite where a field
    /// does not bend at all.
    static double variance(const Spline& spline);

private:
    struct Place {
        Vec3 at;
        Lift lift;
    };

    const KnownData& known_;
    std::vector<std::size_t> contacts_;
    std::vector<Place> places_;
};

}  // namespace realmodel::fields
