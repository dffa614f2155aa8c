// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "fields/functional.hpp"
#include "fields/known_data.hpp"
#include "fields/spline.hpp"

namespace realmodel::fields {

/// Inequalities of which some are met as equalities, those that would not hold otherwise: an active
/// set (Nocedal and Wright 2006, "Numerical Optimization", section 16.5). Active ones are rows of
/// a spline's system, in their order.
class ActiveInequalities {
public:
    struct InequalityState {
        bool active = false, was_released = false, stays = false;
        bool left_out = false;  ///< it contradicts other data
    };

    ActiveInequalities() = default;
    explicit ActiveInequalities(std::vector<Inequality> all)
        : all_(std::move(all)), states_(all_.size()) {}

    const std::vector<Inequality>& all() const { return all_; }
    const std::vector<InequalityState>& states() const { return states_; }
    void set_states(std::vector<InequalityState> states) { states_ = std::move(states); }
    /// Leaves some out from now on, and begins again with none active.
    void leave_out(std::span<const std::size_t> numbers);

    void append_to(std::vector<Functional>& rows) const;
    /// Inequalities that do not hold become active, those that are missed most.
    /// @param met  by so much they may be missed
    /// @return whether there are any
    bool activate(const Spline& spline, double met);
    /// Active ones that would hold by themselves are so no more. One that did not once it was
    /// released stays.
    /// @param first_row  of the active ones
    bool release(const Spline& spline, std::size_t first_row);
    /// Active bounds and polarities that the field would miss most if they were left out, of
    /// several near each other only one, since the others may be right.
    std::vector<std::size_t> suspected(const Spline& spline, std::size_t first_row) const;

private:
    std::vector<Inequality> all_;
    std::vector<InequalityState> states_;
};

/// How steep a field is at some contacts, by their surfaces.
std::vector<std::vector<double>> steepness_on_surfaces(const KnownData& known, const Spline& spline,
                                                       std::span<const std::size_t> contacts);
/// The median; never 0.
double median_steepness(std::vector<double> steepness);

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
    struct SteepnessSample {
        Vec3 at;
        Lift lift;
    };

    const KnownData& known_;
    std::vector<std::size_t> contacts_;
    std::vector<SteepnessSample> places_;
};

}  // namespace realmodel::fields
