// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/values_through.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::fields {

namespace {

/// Of the share of a contact in its tetrahedron: where contacts share corners, none moves far.
constexpr double kLoose = 1e-2;
constexpr int kSteps = 200;         ///< of each solution
constexpr double kReached = 1e-12;  ///< of what contacts miss their levels by at first: nothing

double sum_of_squares(std::span<const double> values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// The matrix A of the weights of contacts, by those values alone that are corners.
class Weights {
public:
    explicit Weights(const LevelsAtContacts& at) : weights_(at.weights) {
        for (const auto& corners : at.corners)
            used_.insert(used_.end(), corners.begin(), corners.end());
        sort_unique(used_);
        corners_.reserve(at.corners.size());
        for (const auto& corners : at.corners) {
            auto& own = corners_.emplace_back();
            for (std::size_t i = 0; i < 4; ++i) {
                const auto place = std::lower_bound(used_.begin(), used_.end(), corners[i]);
                own[i] = static_cast<std::size_t>(place - used_.begin());
            }
        }
    }

    /// The places of the values that are corners, rising.
    const std::vector<std::int64_t>& used() const { return used_; }

    double row(std::size_t contact, std::span<const double> values) const {
        const auto& corners = corners_[contact];
        const auto& weights = weights_[contact];
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i)
            sum += values[corners[i]] * weights[i];
        return sum;
    }

    /// A^T y into `into`.
    void spread(std::span<const double> y, std::vector<double>& into) const {
        into.assign(used_.size(), 0.0);
        for (std::size_t c = 0; c < y.size(); ++c) {
            for (std::size_t i = 0; i < 4; ++i)
                into[corners_[c][i]] += weights_[c][i] * y[c];
        }
    }

private:
    std::span<const std::array<double, 4>> weights_;
    std::vector<std::int64_t> used_;
    std::vector<std::array<std::size_t, 4>> corners_;
};

/// y with (A A^T + loose) y = missed, until its square is at most `least`.
std::vector<double> solved(const Weights& weights, std::span<const double> missed, double least,
                           const Execution& execution) {
    std::vector<double> y(missed.size(), 0.0), way(missed.begin(), missed.end()), rest = way;
    std::vector<double> ahead(way.size()), corners;
    double square = sum_of_squares(rest);
    for (int step = 0; step < kSteps && square > least; ++step) {
        if (execution.progress != nullptr) execution.progress->check();
        weights.spread(way, corners);
        double along = 0;
        for (std::size_t c = 0; c < way.size(); ++c) {
            ahead[c] = weights.row(c, corners) + kLoose * way[c];
            along += way[c] * ahead[c];
        }
        const double far = square / along;
        for (std::size_t c = 0; c < way.size(); ++c) {
            y[c] += far * way[c];
            rest[c] -= far * ahead[c];
        }
        const double before = square;
        square = sum_of_squares(rest);
        for (std::size_t c = 0; c < way.size(); ++c)
            way[c] = rest[c] + square / before * way[c];
    }
    return y;
}

}  // namespace

ValuesThrough values_through(std::span<const double> given, const LevelsAtContacts& at, int rounds,
                             const Execution& execution) {
    const Weights weights(at);
    const auto& used = weights.used();
    if (!used.empty() && (used.front() < 0 || used.back() >= std::ssize(given)))
        throw InputError("option", "a corner is no value");
    std::vector<double> own(used.size()), change;
    std::transform(used.begin(), used.end(), own.begin(),
                   [&](std::int64_t place) { return given[index(place)]; });
    ValuesThrough found{{given.begin(), given.end()}, std::vector<double>(at.levels.size())};
    const auto miss = [&] {
        for (std::size_t c = 0; c < found.missed.size(); ++c)
            found.missed[c] = at.levels[c] - weights.row(c, own);
    };
    miss();
    const double least = kReached * kReached * sum_of_squares(found.missed);
    for (int round = 0; round < rounds; ++round) {
        weights.spread(solved(weights, found.missed, least, execution), change);
        for (std::size_t n = 0; n < own.size(); ++n)
            own[n] += change[n];
        miss();
    }
    for (std::size_t n = 0; n < own.size(); ++n)
        found.values[index(used[n])] = own[n];
    return found;
}

}  // namespace realmodel::fields
