// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/known_data.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

// Of the mean: how much f rises at least along the normal of a dip, and from a level to the next.
constexpr double kLeastRise = 0.02;
// Of the largest moment of what is known: what a tilt that is known has at least.
constexpr double kKnownTilt = 1e-10;

}  // namespace

LocalFrame::LocalFrame(const Lattice& lattice) : middle{}, unit(0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * lattice.spacing[axis] * (lattice.counts[axis] - 1);
        middle[axis] = lattice.origin[axis] + half;
        unit += half * half;
    }
    unit = std::sqrt(unit);
}

KnownData::KnownData(const Lattice& lattice, const FieldData& data)
    : lattice_(lattice), data_(data), frame_(lattice) {
    check();
    for (const Vec3& contact : data.contacts)
        contacts_.push_back(frame_.to_local(contact));
    find_references();
    check_contradictions();
    add_dips();
    hold_tilts();
}

double KnownData::half_spacing() const {
    return 0.5 * std::ranges::min(lattice_.spacing) / frame_.unit;
}

void KnownData::check() const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (lattice_.counts[axis] >= 2 && lattice_.spacing[axis] > 0 &&
            std::isfinite(lattice_.spacing[axis]) && std::isfinite(lattice_.origin[axis]))
            continue;
        throw InputError("option",
                         "a lattice has two nodes along each axis or more, and spacings "
                         "above 0");
    }
    if (data_.surfaces < 1) throw InputError("option", "a field has one surface or more");
    check_places(data_.contacts, "contact");
    check_places(data_.dips, "dip");
    check_places(data_.bounds, "bound");
    if (data_.contact_surfaces.size() != data_.contacts.size() ||
        data_.normals.size() != data_.dips.size() ||
        data_.bound_below.size() != data_.bounds.size() ||
        data_.bound_above.size() != data_.bounds.size()) {
        throw InputError("option",
                         "each contact has a surface, each dip a normal, each bound two "
                         "surfaces");
    }
    for (std::size_t n = 0; n < data_.contacts.size(); ++n) {
        if (data_.contact_surfaces[n] >= 0 && data_.contact_surfaces[n] < data_.surfaces) continue;
        throw InputError("option", "contact " + std::to_string(n) + " is on surface " +
                                       std::to_string(data_.contact_surfaces[n]) + " of " +
                                       std::to_string(data_.surfaces));
    }
    for (std::size_t n = 0; n < data_.normals.size(); ++n) {
        if (std::abs(length(data_.normals[n]) - 1) < 1e-6) continue;
        throw InputError("option", "the normal of dip " + std::to_string(n) + " is not of length 1",
                         -1, {static_cast<std::int64_t>(n)});
    }
    check_bounds();
    check_slits();
}

void KnownData::check_slits() const {
    const Slits& slits = data_.slits;
    const auto all_finite = [](std::span<const double> of) {
        return std::ranges::all_of(of, [](double coordinate) { return std::isfinite(coordinate); });
    };
    const std::size_t nodes = slits.combinations * lattice_.nodes();
    const bool of_data = slits.contacts.size() == slits.count * data_.contacts.size() &&
                         slits.dips.size() == slits.count * data_.dips.size() &&
                         slits.dip_slopes.size() == 3 * slits.count * data_.dips.size() &&
                         slits.bounds.size() == slits.count * data_.bounds.size();
    const bool of_nodes =
        slits.count == 0 ||
        (slits.nodes.size() == slits.count * nodes && slits.same.size() == nodes &&
         slits.bound_combinations.size() == data_.bounds.size() && slits.combinations > 0);
    if (!of_data || !of_nodes || (slits.count == 0 && slits.combinations != 1))
        throw InputError("option", "each datum and node has a coordinate for each slit");
    for (std::size_t n = 0; n < slits.same.size(); ++n) {
        if (slits.same[n] < 0 || slits.same[n] > static_cast<std::int64_t>(n))
            throw InputError("option", "a node is the same as one before it, or itself");
    }
    for (const std::int32_t combination : slits.bound_combinations) {
        if (combination < 0 || static_cast<std::size_t>(combination) >= slits.combinations)
            throw InputError("option", "a bound is on one of the combinations of sides");
    }
    if (slits.normals.size() != slits.count) throw InputError("option", "each slit has a normal");
    for (const Vec3& normal : slits.normals) {
        if (!(std::abs(length(normal) - 1) < 1e-6))
            throw InputError("option", "normals of slits have length 1");
    }
    if (!all_finite(slits.contacts) || !all_finite(slits.dips) || !all_finite(slits.bounds) ||
        !all_finite(slits.dip_slopes) || !all_finite(slits.nodes))
        throw InputError("not_finite", "a coordinate of a slit is not finite");
}

/// The further coordinates of a datum.
Lift KnownData::lift(std::span<const double> of, std::size_t n) const {
    const std::span<const double> row = of.subspan(n * data_.slits.count, data_.slits.count);
    return {row.begin(), row.end()};
}

/// The derivative of f along a vector at a dip.
SlopeAtom KnownData::slope(std::size_t dip, const Vec3& along) const {
    SlopeAtom out{frame_.to_local(data_.dips[dip]), along, lift_of_dip(dip), {}};
    for (std::size_t k = 0; k < data_.slits.count; ++k) {
        const double* const rise = &data_.slits.dip_slopes[3 * (dip * data_.slits.count + k)];
        out.along_lift.push_back(frame_.unit * dot(along, {rise[0], rise[1], rise[2]}));
    }
    return out;
}

void KnownData::check_places(FieldData::Points points, const char* what) const {
    for (std::size_t n = 0; n < points.size(); ++n) {
        const Vec3& p = points[n];
        const bool finite = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
        if (finite && lattice_.contains(p)) continue;
        throw InputError(finite ? "outside" : "not_finite",
                         std::string(what) + " " + std::to_string(n) +
                             (finite ? " lies outside the lattice" : " is not finite"),
                         -1, {static_cast<std::int64_t>(n)}, p);
    }
}

void KnownData::check_bounds() const {
    for (std::size_t n = 0; n < data_.bounds.size(); ++n) {
        const std::int32_t below = data_.bound_below[n], above = data_.bound_above[n];
        if (below >= -1 && above >= -1 && below < data_.surfaces && above < data_.surfaces &&
            (above < 0 || below < above))
            continue;
        throw InputError("option",
                         "bound " + std::to_string(n) + " is above surface " +
                             std::to_string(below) + " and below surface " + std::to_string(above),
                         -1, {static_cast<std::int64_t>(n)}, data_.bounds[n]);
    }
}

void KnownData::find_references() {
    constexpr auto kNone = SIZE_MAX;
    references_.assign(static_cast<std::size_t>(data_.surfaces), kNone);
    for (std::size_t n = contacts_.size(); n-- > 0;)
        references_[surface_of(n)] = n;
    for (std::size_t k = 0; k < references_.size(); ++k) {
        if (references_[k] != kNone) continue;
        throw InputError("no_contacts", "surface " + std::to_string(k) + " has no contact",
                         static_cast<int>(k));
    }
}

/// Two surfaces at one place.
void KnownData::check_contradictions() const {
    std::map<Vec3, std::size_t> first;
    for (std::size_t n = 0; n < contacts_.size(); ++n) {
        const auto [at, is_new] = first.emplace(data_.contacts[n], n);
        if (is_new || surface_of(at->second) == surface_of(n)) continue;
        throw InputError("contradicting", "two surfaces have a contact at one place", surface_of(n),
                         {static_cast<std::int64_t>(at->second), static_cast<std::int64_t>(n)},
                         data_.contacts[n]);
    }
}

void KnownData::add_dips() {
    for (std::size_t n = 0; n < data_.dips.size(); ++n) {
        const Vec3& normal = data_.normals[n];
        const Vec3 first = perpendicular(normal);
        for (const Vec3& along : {first, cross(normal, first)})
            planes_.push_back({{}, {slope(n, along)}, 0, true});
    }
}

Functional KnownData::mean_rise() const {
    if (data_.dips.empty()) {
        throw InputError("no_direction",
                         "neither dips nor a second surface say in which direction a field rises");
    }
    Functional rise;
    const double share = 1 / static_cast<double>(data_.dips.size());
    for (std::size_t n = 0; n < data_.dips.size(); ++n)
        rise.slopes.push_back(slope(n, times(share, data_.normals[n])));
    rise.right = 1;
    return rise;
}

double KnownData::total_gap() const {
    const std::int32_t last = data_.surfaces - 1;
    std::array<Vec3, 2> middles{};
    std::array<double, 2> counts{};
    for (std::size_t n = 0; n < contacts_.size(); ++n) {
        const std::int32_t surface = surface_of(n);
        if (surface != 0 && surface != last) continue;
        const std::size_t end = surface == 0 ? 0 : 1;
        middles[end] = plus(middles[end], contacts_[n]);
        counts[end] += 1;
    }
    const double gap =
        length(minus(times(1 / counts[1], middles[1]), times(1 / counts[0], middles[0])));
    return gap > 0 ? gap : 1;
}

/// f would else be 0: one surface has a mean rise of 1 across dips, more have different levels.
std::vector<Functional> KnownData::fixed(std::span<const double> gaps, int order) const {
    std::vector<Functional> out = planes_;
    const auto add = [&](std::int32_t older, std::int32_t younger, double gap) {
        out.push_back(difference(reference(younger), reference(older)));
        out.back().right = gap;
    };
    if (data_.surfaces < 2) {
        out.push_back(mean_rise());
    } else if (gaps.empty()) {
        add(0, data_.surfaces - 1, total_gap());
    } else {
        for (std::int32_t k = 0; k + 1 < data_.surfaces; ++k)
            add(k, k + 1, gaps[k]);
    }
    out.insert(out.end(), tilts_.begin(), tilts_.end());
    assert(out.size() >= planes_.size() + 1);
    for (Functional& functional : out)
        functional = for_order(order, functional);
    return out;
}

/// Where all data lie in one plane and no dip says how f changes across it, it does not.
void KnownData::hold_tilts() {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    const auto add = [&](const Functional& f) {
        const Vec3 terms = f.of_coordinates();
        const Eigen::Vector3d v(terms[0], terms[1], terms[2]);
        moments += v * v.transpose();
    };
    for (const Functional& f : fixed({}))
        add(f);
    for (std::size_t n = 0; n < contacts_.size(); ++n)
        add(on_surface(n));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    for (Eigen::Index k = 0; k < 3; ++k) {
        if (solver.eigenvalues()(k) > kKnownTilt * solver.eigenvalues()(2)) continue;
        const Eigen::Vector3d v = solver.eigenvectors().col(k);
        tilts_.push_back(Functional::slope({0, 0, 0}, {v(0), v(1), v(2)}));
    }
}

/// sign (f at a bound - the level of a surface)
Functional KnownData::bound(std::size_t n, std::int32_t surface, double sign) const {
    const std::size_t contact = reference(surface);
    return {{{frame_.to_local(data_.bounds[n]), sign, false, lift(data_.slits.bounds, n)},
             {contacts_[contact], -sign, true, lift_of(contact)}},
            {},
            0,
            false};
}

std::vector<Inequality> KnownData::inequalities(int order) const {
    std::vector<Inequality> out;
    for (std::int32_t k = 0; k + 1 < data_.surfaces; ++k) {
        const std::size_t younger = reference(k + 1);
        out.push_back({difference(younger, reference(k)), kLeastRise * total_gap() / data_.surfaces,
                       Inequality::Origin::kOrder, k, contacts_[younger]});
    }
    for (std::size_t n = 0; n < data_.dips.size(); ++n) {
        const Vec3 at = frame_.to_local(data_.dips[n]);
        out.push_back({{{}, {slope(n, data_.normals[n])}, 0, false},
                       kLeastRise,
                       Inequality::Origin::kPolarity,
                       static_cast<std::int64_t>(n),
                       at});
    }
    for (std::size_t n = 0; n < data_.bounds.size(); ++n) {
        const auto item = static_cast<std::int64_t>(n);
        const Vec3 at = frame_.to_local(data_.bounds[n]);
        if (data_.bound_below[n] >= 0)
            out.push_back(
                {bound(n, data_.bound_below[n], 1), 0, Inequality::Origin::kBound, item, at});
        if (data_.bound_above[n] >= 0)
            out.push_back(
                {bound(n, data_.bound_above[n], -1), 0, Inequality::Origin::kBound, item, at});
    }
    for (Inequality& inequality : out)
        inequality.functional = for_order(order, inequality.functional);
    return out;
}

Cube cube_of(const KnownData& known, std::size_t contact, double size) {
    Cube cube{0, 0, 0, known.surface_of(contact)};
    for (std::size_t axis = 0; axis < 3; ++axis)
        cube[axis] = static_cast<std::int64_t>(std::floor(known.contacts()[contact][axis] / size));
    return cube;
}

std::vector<std::size_t> thinned(const KnownData& known, std::size_t most) {
    std::vector<std::size_t> contacts;
    for (double size = 1.0 / 64;; size *= 1.25) {
        std::map<Cube, std::size_t> first;
        for (std::size_t n = 0; n < known.contacts().size(); ++n)
            first.emplace(cube_of(known, n, size), n);
        if (first.size() > most && size < 4) continue;
        contacts.clear();
        for (const auto& [cube, n] : first)
            contacts.push_back(n);
        std::sort(contacts.begin(), contacts.end());
        return contacts;
    }
}

std::vector<std::size_t> spread_pairs(const KnownData& known, std::size_t most) {
    const std::vector<Vec3>& at = known.contacts();
    std::set<std::size_t> numbers;
    for (const std::size_t n : thinned(known, most)) {
        numbers.insert(n);
        std::size_t nearest = n;
        double least = 1e300;
        for (std::size_t m = 0; m < at.size(); ++m) {
            const Vec3 d = minus(at[m], at[n]);
            const double squared = dot(d, d);
            if (m == n || known.surface_of(m) != known.surface_of(n) || !(squared > 0) ||
                squared >= least)
                continue;
            least = squared;
            nearest = m;
        }
        numbers.insert(nearest);
    }
    std::vector<std::size_t> out;
    for (const std::size_t n : numbers) {
        if (n != known.reference(known.surface_of(n))) out.push_back(n);
    }
    return out;
}

std::vector<double> distances_between(const KnownData& known, std::size_t most) {
    const std::vector<Vec3>& at = known.contacts();
    std::vector<std::vector<std::size_t>> on(known.data().surfaces);
    for (const std::size_t n : thinned(known, most))
        on[known.surface_of(n)].push_back(n);
    std::vector<Lift> lifts;
    for (std::size_t n = 0; n < at.size(); ++n)
        lifts.push_back(known.lift_of(n));
    std::vector<double> out;
    for (std::size_t k = 0; k + 1 < on.size(); ++k) {
        std::vector<double> nearest;
        for (const std::size_t n : on[k]) {
            double least = 1e300;
            for (const std::size_t m : on[k + 1]) {
                const Vec3 d = minus(at[m], at[n]);
                least = std::min(least, std::sqrt(dot(d, d) + squared(lifts[m], lifts[n])));
            }
            nearest.push_back(least);
        }
        const auto tenth = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 10);
        std::nth_element(nearest.begin(), tenth, nearest.end());
        out.push_back(std::max(*tenth, 1e-6));
    }
    return out;
}

bool is_against_neighbors(const KnownData& known, std::size_t dip) {
    const FieldData& data = known.data();
    constexpr std::size_t kNearest = 3, kNear = 8;
    constexpr double kAlike = 0.7;
    const Lift lift = known.lift_of_dip(dip);
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t n = 0; n < data.dips.size(); ++n) {
        if (n == dip) continue;
        const Vec3 d = times(1 / known.frame().unit, minus(data.dips[n], data.dips[dip]));
        near.emplace_back(dot(d, d) + squared(known.lift_of_dip(n), lift), n);
    }
    if (near.size() < kNearest) return false;
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), kNear));
    for (std::size_t n = 0; n < near.size(); ++n) {
        const double cosine = dot(data.normals[near[n].second], data.normals[dip]);
        if (n < kNearest ? cosine > -kAlike : cosine > kAlike) return false;
    }
    return true;
}

}  // namespace realmodel::fields
