// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/active_inequalities.hpp"

#include <algorithm>
#include <utility>

namespace realmodel::fields {

namespace {

// So many inequalities become active in one round, those that are missed most.
constexpr std::size_t kMostActivated = 200;
constexpr std::size_t kSampledMisfits = 128;
// Data are suspected if the field would miss them by more, as squares, than this times what four
// fifths of the data are missed by without themselves, and than this share of the most.
constexpr double kSuspect = 8, kAsMuch = 0.1;
constexpr double kApart = 0.1;  // of half of the lattice's diagonal

}  // namespace

void ActiveInequalities::leave_out(std::span<const std::size_t> numbers) {
    for (State& state : states_)  // what was bent for those may be right again
        state = {false, false, false, state.left_out};
    for (const std::size_t n : numbers)
        states_[n].left_out = true;
}

void ActiveInequalities::append_to(std::vector<Functional>& rows) const {
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (!states_[n].active) continue;
        rows.push_back(all_[n].functional);
        rows.back().right = all_[n].least;
    }
}

bool ActiveInequalities::activate(const Spline& spline, double met) {
    std::vector<std::pair<double, std::size_t>> missed;
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (states_[n].active || states_[n].left_out) continue;
        const double lack = all_[n].least - spline.of(all_[n].functional);
        if (lack > met) missed.emplace_back(-lack, n);
    }
    std::sort(missed.begin(), missed.end());
    missed.resize(std::min(missed.size(), kMostActivated));
    for (const auto& [lack, n] : missed) {
        if (states_[n].was_released) states_[n].stays = true;
        states_[n].active = true;
    }
    return !missed.empty();
}

bool ActiveInequalities::release(const Spline& spline, std::size_t first_row) {
    bool any = false;
    std::size_t row = first_row;
    for (State& state : states_) {
        if (!state.active) continue;
        const double force = spline.force(row++);
        if (force >= 0 || state.stays) continue;
        state.active = false;
        state.was_released = true;
        any = true;
    }
    return any;
}

std::vector<std::size_t> ActiveInequalities::suspected(const Spline& spline,
                                                       std::size_t first_row) const {
    std::vector<std::size_t> rows, numbers;
    const std::size_t step = std::max<std::size_t>(1, first_row / kSampledMisfits);
    for (std::size_t row = 0; row < first_row; row += step)
        rows.push_back(row);
    const std::size_t sampled = rows.size();
    std::size_t row = first_row;
    for (std::size_t n = 0; n < all_.size(); ++n) {
        if (!states_[n].active) continue;
        if (all_[n].kind != Inequality::Kind::kOrder) {
            rows.push_back(row);
            numbers.push_back(n);
        }
        ++row;
    }
    if (numbers.empty()) return {};
    const std::vector<double> misfits = spline.misfits_without(rows);
    std::vector<double> sorted = misfits;
    const auto usual = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 4 / 5);
    std::nth_element(sorted.begin(), usual, sorted.end());
    const double most =
        *std::max_element(misfits.begin() + static_cast<std::ptrdiff_t>(sampled), misfits.end());
    const double least = std::max(kSuspect * *usual, kAsMuch * most);
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (misfits[sampled + k] > least) found.emplace_back(-misfits[sampled + k], numbers[k]);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::size_t> out;
    for (const auto& suspect : found) {
        const std::size_t n = suspect.second;
        const auto is_near = [&](std::size_t other) {
            return length(minus(all_[n].at, all_[other].at)) < kApart;
        };
        if (std::ranges::none_of(out, is_near)) out.push_back(n);
    }
    return out;
}

}  // namespace realmodel::fields
