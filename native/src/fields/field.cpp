// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/field.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "base/parallel.hpp"
#include "fields/anisotropy.hpp"
#include "fields/known_data.hpp"
#include "fields/spline.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

using Kind = Inequality::Kind;

constexpr double kMet = 1e-9;       // in the frame: what is left by rounding
constexpr double kLeastGap = 1e-3;  // of the mean gap of levels
// Levels that come out in the wrong order by more than this share of the mean gap are refused.
constexpr double kWrongOrder = 0.5;
constexpr std::size_t kFirstCenters = 600, kSampledContacts = 160, kSampledDips = 90;
constexpr int kMostRounds = 40;
// So many inequalities become active in one round, those that are missed most.
constexpr std::size_t kMostActivated = 200;

/// At most about `most` of some contacts: of each surface one in each of equal cubes.
std::vector<std::size_t> thinned(const KnownData& known, std::size_t most) {
    const std::vector<Vec3>& at = known.contacts();
    std::vector<std::size_t> kept;
    for (double size = 1.0 / 64;; size *= 1.25) {
        std::map<std::array<std::int64_t, 4>, std::size_t> first;
        for (std::size_t n = 0; n < at.size(); ++n) {
            std::array<std::int64_t, 4> key{0, 0, 0, known.surface_of(n)};
            for (std::size_t axis = 0; axis < 3; ++axis)
                key[axis] = static_cast<std::int64_t>(std::floor(at[n][axis] / size));
            first.emplace(key, n);
        }
        if (first.size() > most && size < 4) continue;
        kept.clear();
        for (const auto& [key, n] : first)
            kept.push_back(n);
        std::sort(kept.begin(), kept.end());
        return kept;
    }
}

/// The field while more of the data get into it.
class Solution {
public:
    Solution(const KnownData& known, const FieldOptions& options, const Execution& execution)
        : known_(known),
          options_(options),
          execution_(execution),
          is_center_(known.contacts().size(), 0) {
        const std::size_t most = static_cast<std::size_t>(std::max(options.most_centers, 1));
        const std::size_t all = known.contacts().size();
        if (all <= std::min<std::size_t>(most, 2 * kFirstCenters)) {
            is_center_.assign(all, 1);
        } else {
            for (const std::size_t n : thinned(known, std::min(most, kFirstCenters)))
                is_center_[n] = 1;
        }
        begin(0.0, 0.3, "anisotropy of the field");
        anisotropy_ = options.anisotropy != nullptr ? *options.anisotropy : likely();
        begin(0.3, 0.7, "field through the data");
    }

    /// Rounds until all data are met.
    void solve() {
        fit();
        refuse_contradictions();
        const std::int32_t last = known_.data().surfaces - 1;
        const double mean_gap = last > 0 ? std::abs(level(last) - level(0)) / last : 0;
        refuse_wrong_order(mean_gap);
        inequalities_ = known_.inequalities(kLeastGap * mean_gap);
        refuse_polarities();
        states_.assign(inequalities_.size(), {});
        for (int round = 0; round < kMostRounds; ++round) {
            const bool more_contacts = add_centers();
            const bool more_bounds = activate();
            const bool fewer = !more_bounds && !more_contacts && release();
            if (!more_contacts && !more_bounds && !fewer) break;
            fit();
        }
    }

    Field field(const Lattice& lattice) {
        Field out;
        begin(0.7, 1.0, "values of the field");
        const double unit = known_.frame().unit;
        out.values.resize(lattice.nodes());
        parallel_ranges(
            out.values.size(), 512, execution_,
            [&](std::size_t from, std::size_t to) {
                std::vector<Vec3> at(to - from);
                const auto nx = static_cast<std::size_t>(lattice.counts[0]);
                const auto ny = static_cast<std::size_t>(lattice.counts[1]);
                for (std::size_t n = from; n < to; ++n) {
                    at[n - from] = known_.frame().to_local(
                        lattice.position(static_cast<int>(n % nx), static_cast<int>(n / nx % ny),
                                         static_cast<int>(n / nx / ny)));
                }
                const std::span<double> values(out.values.data() + from, to - from);
                spline_->values_at(at, values);
                for (double& value : values)
                    value *= unit;
            },
            1.0);
        for (std::int32_t k = 0; k < known_.data().surfaces; ++k)
            out.levels.push_back(unit * level(k));
        out.anisotropy = anisotropy_;
        out.centers = std::count(is_center_.begin(), is_center_.end(), 1);
        out.misfit = misfit_ * unit;
        report_missed(out);
        return out;
    }

private:
    struct State {
        bool active = false, stays = false;
    };

    void begin(double from, double to, const char* text) const {
        if (execution_.progress != nullptr) execution_.progress->begin(from, to, text);
    }

    double level(std::int32_t surface) const {
        return spline_->value(known_.contacts()[known_.reference(surface)]);
    }

    Anisotropy likely() const {
        std::vector<Functional> sample;
        const std::vector<Functional>& fixed = known_.fixed();
        const std::size_t dips = known_.data().dips.size();
        const std::size_t each = (dips + kSampledDips - 1) / kSampledDips;
        for (std::size_t n = 0; n < dips; ++n) {
            if (n % each != 0) continue;
            sample.push_back(fixed[2 * n]);
            sample.push_back(fixed[2 * n + 1]);
        }
        sample.insert(sample.end(), fixed.begin() + static_cast<std::ptrdiff_t>(2 * dips),
                      fixed.end());
        for (const std::size_t n : thinned(known_, kSampledContacts)) {
            if (n != known_.reference(known_.surface_of(n))) sample.push_back(known_.on_surface(n));
        }
        return likely_anisotropy(sample, known_.data().normals, execution_);
    }

    void fit() {
        std::vector<Functional> all = known_.fixed();
        for (std::size_t n = 0; n < is_center_.size(); ++n) {
            if (is_center_[n] != 0 && n != known_.reference(known_.surface_of(n)))
                all.push_back(known_.on_surface(n));
        }
        first_active_ = all.size();
        for (std::size_t n = 0; n < states_.size(); ++n) {
            if (!states_[n].active) continue;
            all.push_back(inequalities_[n].functional);
            all.back().right = inequalities_[n].least;
        }
        spline_.emplace(all, map_of(anisotropy_), execution_);
    }

    /// How far contacts are from their surfaces, nearly.
    std::vector<double> misfits() const {
        const std::vector<Vec3>& at = known_.contacts();
        std::vector<double> out(at.size());
        parallel_ranges(
            at.size(), 512, execution_,
            [&](std::size_t from, std::size_t to) {
                const std::span<const Vec3> here(at.data() + from, to - from);
                spline_->values_at(here, std::span<double>(out.data() + from, to - from));
            },
            0.0);
        for (std::size_t n = 0; n < at.size(); ++n)
            out[n] = std::abs(out[n] - level_of_[known_.surface_of(n)]);
        return out;
    }

    void set_levels() {
        level_of_.clear();
        for (std::int32_t k = 0; k < known_.data().surfaces; ++k)
            level_of_.push_back(level(k));
    }

    /// Those of the contacts that are missed most, no two of them near each other.
    bool add_centers() {
        set_levels();
        const std::vector<double> missed = misfits();
        misfit_ = *std::max_element(missed.begin(), missed.end());
        const double tolerance = std::max(options_.tolerance / known_.frame().unit, 1e3 * kMet);
        const auto have =
            static_cast<std::size_t>(std::count(is_center_.begin(), is_center_.end(), 1));
        const auto most = static_cast<std::size_t>(std::max(options_.most_centers, 1));
        std::vector<std::size_t> order;
        for (std::size_t n = 0; n < missed.size(); ++n) {
            if (is_center_[n] == 0 && missed[n] > tolerance) order.push_back(n);
        }
        if (have >= most || order.empty()) return false;
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return missed[a] != missed[b] ? missed[a] > missed[b] : a < b;
        });
        // Cubes as large as a center's share of the contacts' sheets.
        const double size = 1 / std::sqrt(static_cast<double>(have + most));
        std::map<std::array<std::int64_t, 4>, char> taken;
        std::size_t left = std::min(most - have, have);
        bool added = false;
        for (const std::size_t n : order) {
            std::array<std::int64_t, 4> key{0, 0, 0, known_.surface_of(n)};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                key[axis] =
                    static_cast<std::int64_t>(std::floor(known_.contacts()[n][axis] / size));
            }
            if (!taken.emplace(key, 1).second) continue;
            is_center_[n] = 1;
            added = true;
            if (--left == 0) break;
        }
        return added;
    }

    /// Inequalities that do not hold.
    bool activate() {
        std::vector<std::pair<double, std::size_t>> missed;
        for (std::size_t n = 0; n < inequalities_.size(); ++n) {
            if (states_[n].active) continue;
            const double lack = inequalities_[n].least - spline_->of(inequalities_[n].functional);
            if (lack > kMet) missed.emplace_back(-lack, n);
        }
        std::sort(missed.begin(), missed.end());
        missed.resize(std::min(missed.size(), kMostActivated));
        for (const auto& [lack, n] : missed) {
            if (released_[n]) states_[n].stays = true;
            states_[n].active = true;
        }
        return !missed.empty();
    }

    /// Active inequalities that would hold by themselves. One that did not once it was released
    /// stays.
    bool release() {
        bool any = false;
        std::size_t row = first_active_;
        for (std::size_t n = 0; n < states_.size(); ++n) {
            if (!states_[n].active) continue;
            const double force = spline_->force(row++);
            if (force >= 0 || states_[n].stays) continue;
            states_[n].active = false;
            released_[n] = 1;
            any = true;
        }
        return any;
    }

    void refuse_contradictions() const {
        std::size_t row = known_.fixed().size();
        for (std::size_t n = 0; n < is_center_.size(); ++n) {
            if (is_center_[n] == 0 || n == known_.reference(known_.surface_of(n))) continue;
            if (!spline_->left_out(row++)) continue;
            const double missed = std::abs(spline_->of(known_.on_surface(n)));
            if (missed <= 1e3 * kMet) continue;
            throw InputError(
                "contradicting", "contact " + std::to_string(n) + " contradicts others near it",
                known_.surface_of(n), {static_cast<std::int64_t>(n)}, known_.data().contacts[n]);
        }
    }

    void refuse_wrong_order(double mean_gap) const {
        for (std::int32_t k = 0; k + 1 < known_.data().surfaces; ++k) {
            if (level(k + 1) - level(k) >= -kWrongOrder * mean_gap) continue;
            const auto older = known_.reference(k), younger = known_.reference(k + 1);
            throw InputError("wrong_order",
                             "surface " + std::to_string(k + 1) +
                                 " lies on the older side of surface " + std::to_string(k),
                             k,
                             {static_cast<std::int64_t>(older), static_cast<std::int64_t>(younger)},
                             known_.data().contacts[younger]);
        }
    }

    /// Most dips against which the field falls; or one whose nearest neighbors have its attitude,
    /// but the other polarity.
    void refuse_polarities() {
        released_.assign(inequalities_.size(), 0);
        std::vector<std::int64_t> against;
        for (const Inequality& inequality : inequalities_) {
            if (inequality.kind == Kind::kPolarity && spline_->of(inequality.functional) < 0)
                against.push_back(inequality.item);
        }
        const FieldData& data = known_.data();
        if (2 * against.size() > data.dips.size()) {
            throw InputError("against_order",
                             "at " + std::to_string(against.size()) + " of " +
                                 std::to_string(data.dips.size()) +
                                 " dips rock gets younger the other way than the surfaces",
                             -1, against, data.dips[against[0]]);
        }
        for (const std::int64_t dip : against) {
            if (!is_against_neighbors(static_cast<std::size_t>(dip))) continue;
            throw InputError(
                "polarity",
                "dip " + std::to_string(dip) + " has the polarity against its neighbors", -1, {dip},
                data.dips[dip]);
        }
    }

    bool is_against_neighbors(std::size_t dip) const {
        constexpr std::size_t kNearest = 3;
        constexpr double kOpposite = -0.7;
        const FieldData& data = known_.data();
        std::vector<std::pair<double, std::size_t>> near;
        for (std::size_t n = 0; n < data.dips.size(); ++n) {
            const Vec3 d = minus(data.dips[n], data.dips[dip]);
            if (n != dip) near.emplace_back(dot(d, d), n);
        }
        if (near.size() < kNearest) return false;
        std::partial_sort(near.begin(), near.begin() + kNearest, near.end());
        return std::all_of(near.begin(), near.begin() + kNearest, [&](const auto& neighbor) {
            return dot(data.normals[neighbor.second], data.normals[dip]) < kOpposite;
        });
    }

    void report_missed(Field& out) const {
        for (const Inequality& inequality : inequalities_) {
            if (inequality.kind == Kind::kGap) continue;
            const double lack = inequality.least - spline_->of(inequality.functional);
            if (lack <= 1e3 * kMet) continue;
            auto& missed = inequality.kind == Kind::kPolarity ? out.dips_missed : out.bounds_missed;
            if (missed.empty() || missed.back() != inequality.item)
                missed.push_back(inequality.item);
        }
    }

    const KnownData& known_;
    FieldOptions options_;
    Execution execution_;
    std::vector<char> is_center_;
    Anisotropy anisotropy_{};
    std::vector<Inequality> inequalities_;
    std::vector<State> states_;
    std::vector<char> released_;
    std::vector<double> level_of_;
    std::size_t first_active_ = 0;
    double misfit_ = 0;
    std::optional<Spline> spline_;
};

}  // namespace

Field solve_field(const Lattice& lattice, const FieldData& data, const FieldOptions& options,
                  const Execution& execution) {
    const KnownData known(lattice, data);
    Solution solution(known, options, execution);
    solution.solve();
    return solution.field(lattice);
}

}  // namespace realmodel::fields
