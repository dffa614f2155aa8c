// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/functional.hpp"
#include "realmodel/fields/field.hpp"

namespace realmodel::fields {

/// Positions as the solution has them: the lattice's box is about the origin, half of its diagonal
/// long.
struct LocalFrame {
    Vec3 middle;
    double unit;

    explicit LocalFrame(const Lattice& lattice);
    Vec3 to_local(const Vec3& at) const { return times(1 / unit, minus(at, middle)); }
};

/// f of a functional is at least so much.
struct Inequality {
    enum class Origin { kOrder, kPolarity, kBound };

    Functional functional;
    double least;
    Origin kind;
    std::int64_t item;  ///< the older surface, the dip or the bound
    Vec3 at;            ///< about where
};

/// The data as functionals, in a frame.
class KnownData {
public:
    /// @throws InputError as solve_field()
    KnownData(const Lattice& lattice, const FieldData& data);

    const Lattice& lattice() const { return lattice_; }
    const LocalFrame& frame() const { return frame_; }
    const FieldData& data() const { return data_; }
    const std::vector<Vec3>& contacts() const { return contacts_; }
    std::int32_t surface_of(std::size_t contact) const { return data_.contact_surfaces[contact]; }
    /// Of contacts, in the frame.
    double error() const { return data_.error / frame_.unit; }
    /// The contact at which a surface has its level.
    std::size_t reference(std::int32_t surface) const { return references_[surface]; }

    /// What holds in any case: planes of dips, two for each; how fast f rises; and that it is no
    /// steeper in directions of which no datum says anything.
    /// @param gaps  differences of the levels; none: only that of the first and the last is given
    /// @param order  of the splines that take them: see for_order
    std::vector<Functional> fixed(std::span<const double> gaps, int order = 3) const;
    Functional on_surface(std::size_t contact) const {
        return difference(contact, references_[surface_of(contact)]);
    }
    /// Of f at two contacts.
    Functional difference(std::size_t contact, std::size_t from) const {
        return Functional::difference(contacts_[contact], contacts_[from], lift_of(contact),
                                      lift_of(from));
    }
    /// A functional as splines take it whose derivatives of an order are least: with order 2 they
    /// have no slopes, and differences stand for them.
    Functional for_order(int order, const Functional& functional) const {
        return order == 2 ? functional.by_differences(half_spacing()) : functional;
    }
    /// Half of the least edge of the lattice, in the frame.
    double half_spacing() const;
    /// The further coordinates of a contact.
    Lift lift_of(std::size_t contact) const { return lift(data_.slits.contacts, contact); }
    /// Those of a dip.
    Lift lift_of_dip(std::size_t dip) const { return lift(data_.slits.dips, dip); }
    /// Levels that rise, polarities and bounds.
    std::vector<Inequality> inequalities(int order = 3) const;
    /// About the distance of the first surface from the last.
    double total_gap() const;

private:
    void check() const;
    void check_places(FieldData::Points points, const char* what) const;
    void check_bounds() const;
    void check_slits() const;
    void check_contradictions() const;
    void find_references();
    void add_dips();
    Functional mean_rise() const;
    void hold_tilts();
    Lift lift(std::span<const double> of, std::size_t n) const;
    SlopeAtom slope(std::size_t dip, const Vec3& along) const;
    Functional bound(std::size_t n, std::int32_t surface, double sign) const;

    Lattice lattice_;
    FieldData data_;
    LocalFrame frame_;
    std::vector<Vec3> contacts_;
    std::vector<std::size_t> references_;
    std::vector<Functional> planes_, tilts_;
};

/// The cube of some size that a contact lies in, and its surface.
using Cube = std::array<std::int64_t, 4>;
Cube cube_of(const KnownData& known, std::size_t contact, double size);

/// At most about `most` of some contacts: of each surface one in each of equal cubes.
std::vector<std::size_t> thinned(const KnownData& known, std::size_t most);

/// A subset of the data that likelihoods are compared by: about `most` contacts that are spread,
/// and those nearest to them, without the references.
std::vector<std::size_t> spread_pairs(const KnownData& known, std::size_t most);

/// About how far each surface is from the next: a tenth of the contacts, of `most`, have one of the
/// next nearer to them.
std::vector<double> distances_between(const KnownData& known, std::size_t most);

/// Whether the nearest dips have the attitude of one, but the other polarity, and none a little
/// farther away agrees with it, as one on the same limb of a tight fold would.
bool is_against_neighbors(const KnownData& known, std::size_t dip);

}  // namespace realmodel::fields
