// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/ties.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "base/algorithms.hpp"
#include "interpolation/node_loop.hpp"
#include "interpolation/ties/tie_system.hpp"
#include "spatial/hash_grid.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

using Members = std::vector<std::int32_t>;

constexpr double kRadius = 2.5;  // of a kernel: times as far as the data of its level are apart
constexpr std::size_t kMostLevels = 24;
constexpr int kMostPasses = 6;         // over the last level, until what is left is rounding
constexpr double kRounding = 1e-14;    // of the diagonal: no pivot is exactly 0
constexpr double kDependent = 1e-5;    // of a row: less left by others asks for absurd corrections
constexpr double kMostCrowded = 0.02;  // of the square of a row: less left by others asks as much
// the same where inequalities do not hold by little, as a share of the range of the data; nodes may
// be moved by another share of it for them
constexpr double kLittle = 0.005, kMostCrowdedByLittle = 6e-4, kMostMoved = 0.2;

constexpr double kSteep = 1;
constexpr int kMostReleases = 2;       // of one inequality: so the rounds end
constexpr double kSignRidge = 1e-9;    // of the diagonal, where only signs of terms are wanted
constexpr std::size_t kLookedAt = 32;  // data around an inequality

/// Rows that are apart by a distance, or across a fault: those that come first are taken.
class Thinning {
public:
    Thinning(const TieRows& rows, double distance)
        : rows_(rows), distance_(distance), taken_at_(2 * distance) {}

    bool take(std::int32_t row) {
        const SheetNode node = center(row);
        if (taken_at_.any(node.position, distance_, [&](std::size_t i) {
                return tie_kernel(node, center(taken_[i]), distance_) > 0;
            }))
            return false;
        taken_at_.add(node.position);
        taken_.push_back(row);
        return true;
    }

private:
    /// The corner that counts most for a row.
    SheetNode center(std::int32_t row) const {
        const auto& weights = rows_.rows[row].weights;
        const auto most = std::max_element(weights.begin(), weights.end()) - weights.begin();
        return rows_.center(rows_.rows[row].corners[static_cast<std::size_t>(most)]);
    }

    const TieRows& rows_;
    double distance_;
    Members taken_;
    spatial::HashGrid<2> taken_at_;
};

class Tying {
public:
    Tying(const TieRows& rows, double tolerance, const Execution& execution)
        : rows_(rows), tolerance_(tolerance), execution_(execution), z_(rows.heights) {
        state_.assign(rows.rows.size(), TieState::kIdle);
    }

    void run() {
        Members wrong = beyond();
        if (wrong.empty()) return;
        for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
            if (!rows_.rows[i].is_known || !rows_.rows[i].is_contact()) continue;
            state_[i] = TieState::kActive;
            active_.push_back(static_cast<std::int32_t>(i));
        }
        std::size_t count = active_.size();
        for (const std::int32_t row : wrong)
            count += rows_.rows[row].is_contact() ? 0 : 1;
        spacing_ = std::sqrt(rows_.area / static_cast<double>(count));
        if (active_.empty()) activate_some(wrong);
        settle(kMostCrowded);
    }

    /// The same, with inequalities met, too, that were given up and hardly do not hold; none where
    /// there are none of these, or where nodes would be moved far for them.
    std::optional<Tying> closer() const {
        const double range = range_of_data();
        const Members little = abandoned_by(kLittle * range);
        if (little.empty()) return {};
        Tying tying = *this;
        for (const std::int32_t row : little)
            tying.state_[row] = TieState::kIdle;
        if (!tying.activate_some(tying.beyond())) return {};
        tying.settle(kMostCrowdedByLittle);
        for (std::size_t i = 0; i < z_.size(); ++i) {
            if (!(std::abs(tying.z_[i] - z_[i]) <= kMostMoved * range)) return {};
        }
        return tying;
    }

    /// By how much the sheet lies below what a row asks for; above it negative.
    double missing(std::size_t i) const {
        const TieRow& row = rows_.rows[i];
        const double z = row.value(z_);
        if (z < row.lower) return row.lower - z;
        return z > row.upper ? row.upper - z : 0;
    }

    TieTerms terms() && {
        TieTerms terms{std::move(radii_), rows_.positions, rows_.sided, {}};
        for (const auto& of_level : coefficients_)
            terms.coefficients.insert(terms.coefficients.end(), of_level.begin(), of_level.end());
        if (terms.radii.empty()) return {};
        return terms;
    }

private:
    enum class TieState : std::uint8_t { kIdle, kActive, kAbandoned };

    /// Meets active rows, and all that do not hold then, but for those that others leave too little
    /// room: less than `least` of the square of a row.
    void settle(double least) {
        do {
            release_unneeded();
            leave_out_crowded(least);
            meet_active();
        } while (activate_some(beyond()));
    }

    /// The rows that do not hold and could, the worst first.
    Members beyond() const {
        std::vector<std::pair<double, std::int32_t>> violations;
        for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
            if (!rows_.rows[i].is_known || state_[i] != TieState::kIdle) continue;
            const double by = std::abs(missing(i));
            if (by > tolerance_) violations.emplace_back(-by, static_cast<std::int32_t>(i));
        }
        std::sort(violations.begin(), violations.end());
        return transformed(violations, &std::pair<double, std::int32_t>::second);
    }

    double range_of_data() const {
        DataRange range;
        for (const TieRow& row : rows_.rows) {
            if (!row.is_known) continue;
            range.add(row.lower);
            range.add(row.upper);
        }
        return range.size();
    }

    /// The inequalities that were given up, and that do not hold by so much at most.
    Members abandoned_by(double most) const {
        Members abandoned;
        for (std::size_t i = 0; i < state_.size(); ++i) {
            const bool is_abandoned =
                state_[i] == TieState::kAbandoned && !rows_.rows[i].is_contact();
            if (is_abandoned && std::abs(missing(i)) <= most)
                abandoned.push_back(static_cast<std::int32_t>(i));
        }
        return abandoned;
    }

    /// Makes contacts of inequalities that do not hold, of near ones only the first. Whether there
    /// were any.
    bool activate_some(const Members& wrong) {
        Thinning apart(rows_, spacing_ / 2);
        for (const std::int32_t row : wrong) {
            if (!apart.take(row)) continue;
            state_[row] = TieState::kActive;
            target_[row] = missing(static_cast<std::size_t>(row)) > 0 ? rows_.rows[row].lower
                                                                      : rows_.rows[row].upper;
            active_.push_back(row);
        }
        return !wrong.empty();
    }

    double residual(std::int32_t row) const { return target(row) - rows_.rows[row].value(z_); }

    double target(std::int32_t row) const {
        const auto activated = target_.find(row);
        return activated == target_.end() ? rows_.rows[row].lower : activated->second;
    }

    /// Releases inequalities that hold the sheet back from what the others ask for: in the smallest
    /// correction of the nodes alone that meets all active rows, their terms have the wrong sign
    /// (Lawson and Hanson 1974, "Solving Least Squares Problems", chapter 23).
    void release_unneeded() {
        for (;;) {
            Eigen::VectorXd right(static_cast<Eigen::Index>(active_.size()));
            bool has_inequality = false;
            for (std::size_t i = 0; i < active_.size(); ++i) {
                const TieRow& row = rows_.rows[active_[i]];
                has_inequality = has_inequality || !row.is_contact();
                right[static_cast<Eigen::Index>(i)] = target(active_[i]) - row.value(rows_.heights);
            }
            if (!has_inequality) return;
            const Eigen::VectorXd terms =
                TieSystem(rows_, active_, DBL_MIN, kSignRidge).solve(right);
            Members unneeded;
            for (std::size_t i = 0; i < active_.size(); ++i) {
                const std::int32_t row = active_[i];
                if (rows_.rows[row].is_contact() || releases_[row] == kMostReleases) continue;
                const double term = terms[static_cast<Eigen::Index>(i)];
                if (target(row) == rows_.rows[row].lower ? term < 0 : term > 0)
                    unneeded.push_back(static_cast<std::int32_t>(i));
            }
            if (unneeded.empty()) return;
            for (const std::int32_t at : unneeded) {
                const std::int32_t row = active_[at];
                state_[row] = TieState::kIdle;
                target_.erase(row);
                ++releases_[row];
            }
            remove(active_, unneeded);
        }
    }

    /// Gives up active rows that nodes cannot honor beside others: contacts beside contacts first,
    /// so that none of these yields to an inequality.
    void leave_out_crowded(double least) {
        const auto is_contact = [&](std::int32_t row) { return rows_.rows[row].is_contact(); };
        Members contacts;
        std::copy_if(active_.begin(), active_.end(), std::back_inserter(contacts), is_contact);
        if (contacts.size() < active_.size()) leave_out_crowded(std::move(contacts), least);
        leave_out_crowded(active_, least);
    }

    void leave_out_crowded(Members some, double least) {
        while (!some.empty()) {
            const Members crowded = crowded_members(rows_, some, least);
            if (crowded.empty()) return;
            give_up(TieSystem(rows_, some, DBL_MIN, kRounding), some, crowded);
        }
    }

    /// Corrects the heights so that all active rows are met, level by level.
    void meet_active() {
        double narrowest = HUGE_VAL;
        for (const std::int32_t row : active_)
            narrowest = std::min(narrowest, rows_.rows[row].shortest_edge);
        Members members;
        for (std::size_t level = 0;; ++level) {
            if (execution_.progress != nullptr) execution_.progress->check();
            const double distance = std::ldexp(spacing_, -static_cast<int>(level));
            if (radii_.size() == level) add_level(kRadius * distance);
            const bool is_last = level + 1 == kMostLevels || radii_[level] < 0.5 * narrowest;
            members = is_last ? active_ : thinned(members, distance);
            if (members.size() == active_.size()) return meet_all(level);
            meet_some(level, std::move(members), members);
        }
    }

    void add_level(double radius) {
        radii_.push_back(radius);
        coefficients_.emplace_back(z_.size(), 0.0);
        corrections_.emplace_back(z_.size(), 0.0);
    }

    /// Active rows that are apart: those that are so already, and more.
    Members thinned(const Members& before, double distance) const {
        Thinning apart(rows_, distance);
        Members taken;
        for (const Members* rows : {&before, &active_})
            for (const std::int32_t row : *rows)
                if (apart.take(row)) taken.push_back(row);
        return taken;
    }

    Eigen::VectorXd residuals(const Members& members) const {
        Eigen::VectorXd right(static_cast<Eigen::Index>(members.size()));
        for (std::size_t i = 0; i < members.size(); ++i)
            right[static_cast<Eigen::Index>(i)] = residual(members[i]);
        return right;
    }

    /// One level of several: rows that others leave no room for wait for narrower kernels.
    void meet_some(std::size_t level, Members some, Members& members) {
        members = some;
        while (!some.empty()) {
            const Eigen::VectorXd right = residuals(some);
            if (right.cwiseAbs().maxCoeff() <= tolerance_) return;
            const TieSystem system(rows_, some, radii_[level], kRounding);
            const Members dependent = system.dependent(kDependent);
            if (dependent.empty()) return correct(level, some, system.solve(right));
            remove(some, dependent);
        }
    }

    /// The last level: what is left is rounding.
    void meet_all(std::size_t level) {
        while (!active_.empty()) {
            if (residuals(active_).cwiseAbs().maxCoeff() <= 0) return;
            const TieSystem system(rows_, active_, radii_[level], kRounding);
            const Members dependent = system.dependent(kDependent);
            if (dependent.empty()) return meet_with(system, level);
            give_up(system, active_, dependent);
        }
    }

    void meet_with(const TieSystem& system, std::size_t level) {
        double before = HUGE_VAL;
        for (int pass = 0; pass < kMostPasses; ++pass) {
            const Eigen::VectorXd right = residuals(active_);
            const double worst = right.cwiseAbs().maxCoeff();
            if (!(worst < 0.5 * before) || worst <= 0.01 * tolerance_) return;
            before = worst;
            correct(level, active_, system.solve(right));
        }
    }

    /// Leaves rows out that others leave no room for, of `members` as of the active ones.
    void give_up(const TieSystem& system, Members& members, const Members& dependent) {
        Members victims;
        for (const std::int32_t at : dependent)
            victims.push_back(that_yields(system, members, at));
        sort_unique(victims);
        for (const std::int32_t victim : victims)
            state_[members[victim]] = TieState::kAbandoned;
        const auto is_abandoned = [&](std::int32_t row) {
            return state_[row] == TieState::kAbandoned;
        };
        std::erase_if(members, is_abandoned);
        std::erase_if(active_, is_abandoned);
    }

    /// The place in `members` of the row that is left out for one: in the place of a contact the
    /// most alike of the inequalities that have a product with it, or else with such a row.
    std::int32_t that_yields(const TieSystem& system, const Members& members,
                             std::int32_t at) const {
        const auto is_contact = [&](std::int32_t place) {
            return rows_.rows[members[place]].is_contact();
        };
        if (!is_contact(at)) return at;
        std::vector<bool> is_seen(members.size(), false);
        is_seen[at] = true;
        for (Members ring{at}, next; !ring.empty(); ring.swap(next), next.clear()) {
            std::int32_t victim = at;
            double most = 0;
            for (const std::int32_t from : ring) {
                for (const std::int32_t to : system.related(from)) {
                    if (is_seen[to]) continue;
                    is_seen[to] = true;
                    next.push_back(to);
                    if (is_contact(to) || system.likeness(from, to) <= most) continue;
                    victim = to;
                    most = system.likeness(from, to);
                }
            }
            if (victim != at) return victim;
        }
        return at;
    }

    static void remove(Members& from, const Members& places) {
        for (auto place = places.rbegin(); place != places.rend(); ++place)
            from.erase(from.begin() + *place);
    }

    void correct(std::size_t level, const Members& members, const Eigen::VectorXd& amounts) {
        auto& coefficients = coefficients_[level];
        for (std::size_t i = 0; i < members.size(); ++i) {
            const TieRow& row = rows_.rows[members[i]];
            for (std::size_t k = 0; k < 3; ++k)
                coefficients[row.corners[k]] +=
                    row.weights[k] * amounts[static_cast<Eigen::Index>(i)];
        }
        const KernelSum sum(rows_.positions, rows_.sided, rows_.faults, coefficients,
                            radii_[level]);
        const NodeLoop loop{z_.size(), 256, execution_};
        loop.over_nodes([] { return 0; },
                        [&](int, std::size_t i) {
                            corrections_[level][i] =
                                sum.at(rows_.center(static_cast<std::int32_t>(i)));
                            double correction = 0;
                            for (const auto& of_level : corrections_)
                                correction += of_level[i];
                            z_[i] = rows_.heights[i] + correction;
                        });
    }

    const TieRows& rows_;
    double tolerance_;
    Execution execution_;
    std::vector<double> z_;  // at the centers, corrected
    std::vector<TieState> state_;
    Members active_;
    std::unordered_map<std::int32_t, double> target_;  // of active inequalities
    std::unordered_map<std::int32_t, int> releases_;
    double spacing_ = 0;
    std::vector<double> radii_;
    std::vector<std::vector<double>> coefficients_, corrections_;  // of each level
};

/// Whether an inequality holds beside near data only if the surface is steeper than `slope`, and no
/// contact so near that it holds there, too, implies it.
bool is_steep(const TieData& data, std::size_t i, std::span<const spatial::Neighbor> near,
              double slope) {
    double steepest = 0, implied = 0;
    for (const spatial::Neighbor& other : near) {
        const auto j = static_cast<std::size_t>(other.point);
        if (j == i) continue;
        const double away = std::sqrt(other.squared_distance);
        const double rise = std::max(data.lower[i] - data.upper[j], data.lower[j] - data.upper[i]);
        steepest = std::max(steepest, rise / away);
        if (data.lower[j] == data.upper[j]) implied = std::max(implied, -rise / away);
    }
    return steepest > slope && !(implied > kSteep * steepest);
}

/// The inequalities that hold beside the data around only if the surface is steep: steeper by
/// `kSteep` than the data are on the whole.
std::vector<bool> steep_bounds(const TieData& data, std::span<const PlanPosition> nodes) {
    std::vector<bool> steep(data.places.size(), false);
    if (data.places.empty()) return steep;
    DataRange range;
    for (std::size_t i = 0; i < steep.size(); ++i) {
        range.add(data.lower[i]);
        range.add(data.upper[i]);
    }
    const spatial::PlanBox box = spatial::box_around(nodes);
    const double slope = kSteep * range.size() / std::max(box.width(), box.height());
    const spatial::NearestPoints tree(data.places);
    std::vector<spatial::Neighbor> near;
    for (std::size_t i = 0; i < steep.size(); ++i) {
        if (data.lower[i] == data.upper[i]) continue;
        tree.find(data.places[i], kLookedAt, near);
        steep[i] = is_steep(data, i, near, slope);
    }
    return steep;
}

}  // namespace

Ties tie(const TiedSheets& sheets, const TieData& data, double tolerance,
         const Execution& execution) {
    const TieRows rows(sheets, data);
    std::optional<Tying> tying(std::in_place, rows, tolerance, execution);
    const auto missing = [&] {
        std::vector<double> differences(rows.rows.size(), std::numeric_limits<double>::quiet_NaN());
        for (std::size_t i = 0; i < differences.size(); ++i)
            if (rows.rows[i].is_known) differences[i] = tying->missing(i);
        return differences;
    };
    Ties ties;
    ties.before = missing();
    tying->run();
    if (std::optional<Tying> closer = tying->closer()) tying.emplace(std::move(*closer));
    ties.after = missing();
    ties.terms = std::move(*tying).terms();
    return ties;
}

CrowdedData crowded_data(const TiedSheets& sheet, const TieData& data, double least) {
    const TieRows rows(sheet, data);
    const std::vector<bool> contradicts = steep_bounds(data, sheet.nodes);
    Members members;
    std::vector<PlanPosition> places;
    for (std::size_t i = 0; i < rows.rows.size(); ++i) {
        if (!rows.rows[i].is_known || !(rows.rows[i].is_contact() || contradicts[i])) continue;
        members.push_back(static_cast<std::int32_t>(i));
        places.push_back(data.places[i]);
    }
    CrowdedData crowded;
    const spatial::NearestPoints tree(places);
    std::vector<spatial::Neighbor> near;
    for (const std::int32_t at : crowded_members(rows, members, least)) {
        crowded.numbers.push_back(members[at]);
        tree.find(places[at], 2, near);
        crowded.room.push_back(std::sqrt(near.back().squared_distance));
    }
    return crowded;
}

}  // namespace realmodel::interpolation
