// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/field.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "fields/frame_function.hpp"
#include "fields/known_data.hpp"
#include "fields/lattice_values.hpp"
#include "fields/likely_field.hpp"
#include "fields/spline.hpp"
#include "fields/spline_constraints.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

using Origin = Inequality::Origin;

constexpr double kTolerance = 1e-9;  // in the frame: what is left by rounding
constexpr std::size_t kFirstCenters = 600;
constexpr int kMostRounds = 40;
// What leaving out each of the suspected must save, in variances of what is left. Exact data save
// up to 120, wrong ones millions.
constexpr double kMinVarianceGain = 400;
// What a bound contradicts: so many data at most, and those that count this much of the first one.
constexpr std::size_t kMostContradicted = 4;
constexpr double kMinShare = 0.25;
// Edges of the lattice over which a drawn function is averaged that has no derivatives.
constexpr double kAveragingCells = 4;

/// The field while more of the data get into it.
class Solution {
public:
    Solution(const KnownData& known, const FieldOptions& options, const Execution& execution)
        : known_(known),
          options_(options),
          execution_(execution),
          is_center_(known.contacts().size(), 0),
          beds_(known) {
        if (options.draw != nullptr) {
            draw(*options.draw);
            return;
        }
        const std::size_t most = static_cast<std::size_t>(std::max(options.most_centers, 1));
        const std::size_t all = known.contacts().size();
        if (all <= std::min<std::size_t>(most, 2 * kFirstCenters)) {
            is_center_.assign(all, 1);
        } else {
            for (const std::size_t n : thinned(known, std::min(most, kFirstCenters)))
                is_center_[n] = 1;
        }
        begin_phase(execution_.progress, 0.0, 0.3, "anisotropy of the field");
        LikelyField field = likely_field(known, options.is_even, execution);
        likely_ = field.likely;
        gaps_ = std::move(field.gaps);
        plain_shares_ = std::move(field.plain_shares);
        begin_phase(execution_.progress, 0.3, 0.7, "field through the data");
    }

    /// Rounds until all data are met, but for those that contradict others.
    void solve() {
        fit();
        std::vector<Inequality> inequalities = known_.inequalities(likely_.order);
        for (Inequality& inequality : inequalities)
            if (drawn_) inequality.least -= drawn_->of(inequality.functional);
        active_ = ActiveInequalities(std::move(inequalities));
        if (drawn_) {
            apply_omissions();
            meet();
            return;
        }
        refuse_contradictions();
        refuse_polarities();
        meet();
        for (int round = 0; round < kMostRounds && leave_out(); ++round) {
        }
        if (likely_.is_even) make_even();
    }

    Field field() {
        Field out;
        begin_phase(execution_.progress, 0.7, 1.0, "values of the field");
        const double unit = known_.frame().unit;
        for (std::size_t combination = 0; combination < known_.data().slits.combinations;
             ++combination) {
            std::vector<double> at_nodes =
                function().at_nodes(known_.lattice(), combination, execution_);
            for (double& value : at_nodes)
                value *= unit;
            const std::vector<double> smooth = balanced(at_nodes, known_.lattice(), execution_);
            out.values.insert(out.values.end(), smooth.begin(), smooth.end());
        }
        make_same(out.values);
        for (const double level : function().levels())
            out.levels.push_back(unit * level);
        out.kind = kind();
        out.centers = std::count(is_center_.begin(), is_center_.end(), 1);
        out.misfit = misfit_ * unit;
        out.plain_shares = plain_shares_;
        report_missed(out);
        std::vector<char> is_held(known_.data().bounds.size(), 1);
        for (const std::int64_t bound : out.bounds_missed)
            is_held[static_cast<std::size_t>(bound)] = 0;
        keep_bounds(known_.lattice(), known_.data(), is_held, out.levels, out.values);
        make_same(out.values);
        return out;
    }

private:
    /// A function of the kind that was found, which the data condition.
    void draw(const FieldDraw& field_draw) {
        const FunctionKind& kind = field_draw.kind;
        even_ = kind.even;
        even_error_ = kind.even_error;
        likely_ = {kind.anisotropy,
                   {kind.value_error, kind.slope_error},
                   kind.order,
                   kind.lift,
                   {kind.throws.begin(), kind.throws.end()}};
        gaps_ = kind.gaps;
        if (kind.centers.size() != is_center_.size())
            throw InputError("option", "a field is drawn with the contacts that it was found of");
        is_center_.assign(kind.centers.begin(), kind.centers.end());
        const DrawnNumbers& numbers = field_draw.numbers;
        const std::size_t slits = known_.data().slits.count;
        if (numbers.dimensions != 3 + slits || numbers.directions.empty() ||
            numbers.directions.size() % numbers.dimensions != 0 || numbers.steps.empty() ||
            numbers.steps.size() * numbers.dimensions % numbers.directions.size() != 0 ||
            numbers.slope_errors.size() != 2 * known_.data().dips.size() + even_.size())
            throw InputError("option", "a function is drawn of numbers for each line and slope");
        const double rough = kAveragingCells * 2 * known_.half_spacing();
        const double most = *std::ranges::max_element(kind.anisotropy.ratios);
        const double reach = std::max(most, 1.0) + 2 * rough + farthest_lift();
        drawn_.emplace(likely_.smoothness(), kind.scale, reach, rough, numbers);
        begin_phase(execution_.progress, 0.0, 0.7, "field through the data");
    }

    /// How far further coordinates are from 0 at most, as they are scaled.
    double farthest_lift() const {
        const Slits& slits = known_.data().slits;
        double sum = 0;
        for (const std::span<const double> coordinates :
             {slits.contacts, slits.dips, slits.bounds, slits.nodes}) {
            for (const double coordinate : coordinates)
                sum = std::max(sum, std::abs(coordinate));
        }
        double far = std::abs(likely_.lift) * sum * static_cast<double>(slits.count);
        for (const Vec3& thrown : likely_.throws)
            far += sum * length(thrown);
        return far;
    }

    /// The inequalities that the field left out whose kind is drawn.
    void apply_omissions() {
        const std::span<const std::uint8_t> left_out = options_.draw->kind.left_out;
        if (left_out.size() != active_.all().size())
            throw InputError("option", "a field is drawn with the bounds that it was found of");
        std::vector<std::size_t> numbers;
        for (std::size_t n = 0; n < left_out.size(); ++n) {
            if (left_out[n] != 0) numbers.push_back(n);
        }
        active_.leave_out(numbers);
    }

    FunctionKind kind() const {
        FunctionKind out{likely_.anisotropy,
                         likely_.order,
                         likely_.errors.value,
                         likely_.errors.slope,
                         likely_.lift,
                         {likely_.throws.begin(), likely_.throws.end()},
                         even_.empty() ? spline_->scale() : scale_,
                         gaps_,
                         {is_center_.begin(), is_center_.end()},
                         {},
                         even_,
                         even_error_};
        for (const auto& state : active_.states())
            out.left_out.push_back(state.left_out ? 1 : 0);
        return out;
    }

    /// Rounds in which contacts and inequalities get into the field, or out of it.
    void meet() {
        for (int round = 0; round < kMostRounds; ++round) {
            const bool more_contacts = add_centers();
            const bool more_bounds = active_.activate(*spline_, kTolerance);
            const bool fewer =
                !more_bounds && !more_contacts && active_.release(*spline_, first_active_);
            if (!more_contacts && !more_bounds && !fewer) break;
            fit();
        }
    }

    /// Solves it anew until it rises as steeply along beds, nearly.
    void make_even() {
        scale_ = spline_->scale();  // what is asked for here says nothing of it
        even_error_ = EvenSteepness::variance(*spline_);
        for (int round = 0; round < EvenSteepness::kRounds; ++round) {
            even_ = beds_.directions(*spline_);
            fit();
            meet();
        }
    }

    FrameFunction function() const { return {known_, *spline_, drawn_ ? &*drawn_ : nullptr}; }

    /// Nodes that are one place beyond tips get the value of the first of them.
    void make_same(std::vector<double>& values) const {
        const std::span<const std::int64_t> same = known_.data().slits.same;
        for (std::size_t n = 0; n < same.size(); ++n)
            values[n] = values[static_cast<std::size_t>(same[n])];
    }

    void fit() {
        std::vector<Functional> all = known_.fixed(gaps_, likely_.order);
        first_contact_ = all.size();
        contacts_of_rows_.clear();
        for (std::size_t n = 0; n < is_center_.size(); ++n) {
            if (is_center_[n] == 0 || n == known_.reference(known_.surface_of(n))) continue;
            contacts_of_rows_.push_back(n);
            all.push_back(known_.on_surface(n));
        }
        const std::size_t first_even = all.size();
        if (!even_.empty()) {
            for (Functional& row : beds_.rows(even_, likely_.order, even_error_))
                all.push_back(std::move(row));
        }
        first_active_ = all.size();
        active_.append_to(all);
        if (drawn_) subtract_drawn(all, first_even);
        spline_.emplace(all, likely_.smoothness(), execution_);
    }

    /// Leaves to the spline what the drawn function and the errors that are drawn do not have.
    void subtract_drawn(std::vector<Functional>& rows, std::size_t first_even) const {
        const FieldDraw& draw = *options_.draw;
        const std::span<const double> errors = draw.numbers.slope_errors;
        const std::size_t of_dips = 2 * known_.data().dips.size();
        for (std::size_t row = 0; row < first_active_; ++row) {
            rows[row].right -= drawn_->of(rows[row]);
            const double scale = draw.kind.scale;
            if (row < of_dips)
                rows[row].right -= std::sqrt(draw.kind.slope_error * scale) * errors[row];
            else if (row >= first_even)
                rows[row].right -=
                    std::sqrt(even_error_ * scale) * errors[of_dips + row - first_even];
        }
    }

    /// How far contacts are from their surfaces, nearly.
    std::vector<double> misfits() const {
        const std::vector<Vec3>& at = known_.contacts();
        std::vector<double> out(at.size());
        parallel_ranges(
            at.size(), 512, execution_,
            [&](std::size_t from, std::size_t to) {
                const std::span<const Vec3> here(at.data() + from, to - from);
                const std::size_t slits = known_.data().slits.count;
                const auto lifts =
                    known_.data().slits.contacts.subspan(slits * from, slits * (to - from));
                const std::span<double> values(out.data() + from, to - from);
                function().values_at(here, lifts, values);
            },
            0.0);
        const std::vector<double> level_of = function().levels();
        for (std::size_t n = 0; n < at.size(); ++n)
            out[n] = std::abs(out[n] - level_of[known_.surface_of(n)]);
        return out;
    }

    /// Those of the contacts that are missed most, no two of them near each other, of all surfaces
    /// by turns.
    bool add_centers() {
        const std::vector<double> missed = misfits();
        misfit_ = *std::max_element(missed.begin(), missed.end());
        const auto have =
            static_cast<std::size_t>(std::count(is_center_.begin(), is_center_.end(), 1));
        const auto most = static_cast<std::size_t>(std::max(options_.most_centers, 1));
        if (have >= most) return false;
        const std::vector<std::size_t> order = by_turns(missed);
        // Cubes as large as a center's share of the contacts' sheets.
        const double size = 1 / std::sqrt(static_cast<double>(have + most));
        std::set<Cube> taken;
        std::size_t left = std::min(most - have, have);
        for (const std::size_t n : order) {
            if (left == 0) break;
            if (!taken.insert(cube_of(known_, n, size)).second) continue;
            is_center_[n] = 1;
            --left;
        }
        return !order.empty();
    }

    /// The contacts that are missed by more than the tolerance, on each surface the worst first.
    std::vector<std::size_t> by_turns(const std::vector<double>& missed) const {
        const double error = std::sqrt(std::max(0.0, likely_.errors.value * spline_->scale()));
        const double tolerance =
            std::max({options_.tolerance / known_.frame().unit, 1e3 * kTolerance, 2 * error});
        std::vector<std::vector<std::size_t>> on(known_.data().surfaces);
        for (std::size_t n = 0; n < missed.size(); ++n) {
            if (is_center_[n] == 0 && missed[n] > tolerance) on[known_.surface_of(n)].push_back(n);
        }
        std::vector<std::pair<std::size_t, std::size_t>> ranked;
        for (std::vector<std::size_t>& numbers : on) {
            std::ranges::sort(numbers, {}, [&](std::size_t n) { return std::pair(-missed[n], n); });
            for (std::size_t rank = 0; rank < numbers.size(); ++rank)
                ranked.emplace_back(rank, numbers[rank]);
        }
        std::sort(ranked.begin(), ranked.end());
        return transformed(ranked, &std::pair<std::size_t, std::size_t>::second);
    }

    /// Takes out inequalities that contradict other data, if there are any: those that the field
    /// would miss most without them. It pays if what is left needs so much less bending that each
    /// of them had taken far more than chance; else they stay.
    bool leave_out() {
        const std::vector<std::size_t> suspects = active_.suspected(*spline_, first_active_);
        if (suspects.empty()) return false;
        const std::vector<ActiveInequalities::InequalityState> before = active_.states();
        const double energy = spline_->energy();
        active_.leave_out(suspects);
        fit();
        meet();
        const double least =
            kMinVarianceGain * static_cast<double>(suspects.size()) * spline_->scale();
        if (energy - spline_->energy() > least) return true;
        active_.set_states(before);
        fit();
        return false;
    }

    void refuse_contradictions() const {
        if (likely_.errors.value > 0) return;
        std::size_t row = first_contact_;
        for (const std::size_t n : contacts_of_rows_) {
            if (!spline_->left_out(row++)) continue;
            const double missed = std::abs(spline_->of(known_.on_surface(n)));
            if (missed <= 1e3 * kTolerance) continue;
            throw InputError(
                "contradicting", "contact " + std::to_string(n) + " contradicts others near it",
                known_.surface_of(n), {static_cast<std::int64_t>(n)}, known_.data().contacts[n]);
        }
    }

    /// Most dips against which the field falls; or one whose nearest neighbors have its attitude,
    /// but the other polarity.
    void refuse_polarities() {
        std::vector<std::int64_t> against;
        for (const Inequality& inequality : active_.all()) {
            if (inequality.kind == Origin::kPolarity && spline_->of(inequality.functional) < 0)
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
            if (!is_against_neighbors(known_, static_cast<std::size_t>(dip))) continue;
            throw InputError(
                "polarity",
                "dip " + std::to_string(dip) + " has the polarity against its neighbors", -1, {dip},
                data.dips[dip]);
        }
    }

    void report_missed(Field& out) const {
        for (const Inequality& inequality : active_.all()) {
            const double lack = inequality.least - spline_->of(inequality.functional);
            if (lack <= 1e3 * kTolerance || inequality.kind == Origin::kOrder) continue;
            const bool is_dip = inequality.kind == Origin::kPolarity;
            auto& missed = is_dip ? out.dips_missed : out.bounds_missed;
            if (!missed.empty() && missed.back() == inequality.item) continue;
            missed.push_back(inequality.item);
            if (!is_dip) out.contradicted.push_back(contradicted(inequality));
        }
    }

    /// The data that say where the field is at a bound that is missed.
    std::vector<Datum> contradicted(const Inequality& bound) const {
        const Functional& of_bound = bound.functional;
        const std::vector<double> weights = spline_->weights_for(of_bound);
        std::map<std::pair<Datum::Kind, std::int64_t>, double> counts;
        for (std::size_t row = 0; row < 2 * known_.data().dips.size(); ++row)
            counts[{Datum::Kind::kDip, static_cast<std::int64_t>(row / 2)}] +=
                std::abs(weights[row]);
        std::size_t row = first_contact_;
        for (const std::size_t n : contacts_of_rows_)
            counts[{Datum::Kind::kContact, static_cast<std::int64_t>(n)}] +=
                std::abs(weights[row++]);
        row = first_active_;  // after those of beds
        const auto is_bound = [](const Inequality& other) { return other.kind == Origin::kBound; };
        for (std::size_t n = 0; n < active_.all().size(); ++n) {
            if (!active_.states()[n].active) continue;
            const Inequality& other = active_.all()[n];
            const double count = std::abs(weights[row++]);
            if (other.kind == Origin::kPolarity) counts[{Datum::Kind::kDip, other.item}] += count;
            // one on the same side says the same
            if (is_bound(other) &&
                other.functional.values[0].weight * of_bound.values[0].weight < 0)
                counts[{Datum::Kind::kBound, other.item}] += count;
        }
        std::vector<std::pair<double, Datum>> sorted;
        for (const auto& [datum, count] : counts)
            sorted.push_back({count, {datum.first, datum.second}});
        std::ranges::stable_sort(sorted, std::greater{}, &std::pair<double, Datum>::first);
        std::vector<Datum> out;
        for (const auto& [count, datum] : sorted) {
            if (out.size() == kMostContradicted || count < kMinShare * sorted[0].first) break;
            out.push_back(datum);
        }
        return out;
    }

    const KnownData& known_;
    FieldOptions options_;
    Execution execution_;
    std::vector<char> is_center_;
    std::vector<double> gaps_, plain_shares_;
    Likely likely_;
    ActiveInequalities active_;
    EvenSteepness beds_;
    std::vector<Vec3> even_;  // of its places
    double even_error_ = 0, scale_ = 0;
    std::size_t first_contact_ = 0, first_active_ = 0;  // rows
    std::vector<std::size_t> contacts_of_rows_;         // from the first on
    double misfit_ = 0;
    std::optional<Spline> spline_;
    std::optional<RandomFunction> drawn_;  // what is drawn: the field is this and the spline
};

}  // namespace

Field solve_field(const Lattice& lattice, const FieldData& data, const FieldOptions& options,
                  const Execution& execution) {
    const KnownData known(lattice, data);
    Solution solution(known, options, execution);
    solution.solve();
    return solution.field();
}

}  // namespace realmodel::fields
