// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "fields/known_data.hpp"
#include "fields/spline.hpp"

namespace realmodel::fields {

/// Inequalities of which some are met as equalities, those that would not hold otherwise: an active
/// set (Nocedal and Wright 2006, "Numerical Optimization", section 16.5). Active ones are rows of
/// a spline's system, in their order.
class ActiveInequalities {
public:
    struct State {
        bool active = false, was_released = false, stays = false;
        bool left_out = false;  ///< it contradicts other data
    };

    ActiveInequalities() = default;
    explicit ActiveInequalities(std::vector<Inequality> all)
        : all_(std::move(all)), states_(all_.size()) {}

    const std::vector<Inequality>& all() const { return all_; }
    const std::vector<State>& states() const { return states_; }
    void set_states(std::vector<State> states) { states_ = std::move(states); }
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
    std::vector<State> states_;
};

}  // namespace realmodel::fields
