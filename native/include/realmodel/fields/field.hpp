// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

/// Faults on whose two sides f differs. Around the tips of those that die out within it is one
/// function. Each gives places a further coordinate, which jumps across it. Of each datum these
/// come one after another.
struct Slits {
    std::size_t count = 0;  ///< of faults
    std::span<const double> contacts, dips, bounds;
    std::span<const double> dip_slopes;  ///< by how much they rise there, three for each
    std::span<const std::array<double, 3>> normals;  ///< of the faults, in the mean, of length 1
    std::size_t combinations = 1;                    ///< combinations of sides of them
    /// Of the lattice's nodes, on one combination of sides after another, each continued as if the
    /// faults were not there.
    std::span<const double> nodes;
    /// Of these nodes the first one that is the same place: beyond tips.
    std::span<const std::int64_t> same;
    std::span<const std::int32_t> bound_combinations;  ///< on which combination of sides a bound is
};

/// What is known of a field f whose level sets are surfaces, numbered from the oldest, which has
/// the lowest level.
struct FieldData {
    using Points = std::span<const std::array<double, 3>>;

    int surfaces = 0;
    Points contacts;  ///< on surfaces
    std::span<const std::int32_t> contact_surfaces;
    Points dips;                                ///< where the direction of f's gradient is known
    Points normals;                             ///< it; of length 1, toward younger rock
    Points bounds;                              ///< between surfaces
    std::span<const std::int32_t> bound_below;  ///< f is above the level of this one; -1: none
    std::span<const std::int32_t> bound_above;  ///< f is below the level of this one; -1: none
    Slits slits{};
    double error = 0;  ///< how far contacts may be off, as a standard deviation
};

/// How much less f may bend along some directions than across them.
struct AxisRatios {
    std::array<std::array<double, 3>, 3> axes;  ///< orthonormal; the first is the fold axis
    std::array<double, 3> ratios;  ///< 1: as across; 0.01: a hundredth; with order 5 1 / range
};

/// What kind of random function a field is, as its data say. Lengths and values are in units of
/// half of the lattice's diagonal.
struct FunctionKind {
    AxisRatios anisotropy;
    int order = 3;  ///< of the derivatives that are least: 2 where rough, 5: all up to the fifth
    double value_error = 0, slope_error = 0;    ///< variances of errors, in units of the kernel
    double lift = 1;                            ///< by how much further coordinates are scaled
    std::vector<std::array<double, 3>> throws;  ///< by how much places move for each unit of them
    double scale = 0;                           ///< variance per unit of the kernel
    std::vector<double> gaps;                   ///< differences of the levels; none: they are free
    std::vector<std::uint8_t> centers;          ///< (contacts) which of them carry the field
    std::vector<std::uint8_t> left_out;         ///< inequalities that contradict other data
    /// Where beds keep their thickness, of places all over the lattice the vector along which the
    /// field rises by about 1, and the variance of its error, in units of the kernel.
    std::vector<std::array<double, 3>> even;
    double even_error = 0;
};

/// Independent normal numbers that a random function is made of: on lines in random directions a
/// motion in random steps.
struct DrawnNumbers {
    std::size_t dimensions = 3;            ///< three, and one more for each slit
    std::span<const double> directions;    ///< of each line so many
    std::span<const double> steps;         ///< of line 0, then of line 1
    std::span<const double> slope_errors;  ///< two for each dip, then one for each place of `even`
};

/// A field that is drawn as the data allow: with the kind that solve_field() found of the same data
/// and lattice.
struct FieldDraw {
    FunctionKind kind;
    DrawnNumbers numbers;
};

struct FieldOptions {
    double tolerance = 0;     ///< distance by which surfaces may miss contacts; 0: only by rounding
    int most_centers = 2500;  ///< at most so many contacts carry the field
    const FieldDraw* draw = nullptr;  ///< null: the smoothest field, the mean of all
    /// Beds keep their thickness, as in parallel folds; none: if data that are left out say so.
    std::optional<bool> is_even{};
};

/// A contact, dip or bound, by its row.
struct Datum {
    enum class Kind { kContact, kDip, kBound };

    Kind kind;
    std::int64_t row;
};

struct Field {
    std::vector<double> values;  ///< of the lattice's nodes, on each combination of sides of slits
    std::vector<double> levels;  ///< of the surfaces, rising
    FunctionKind kind;
    std::int64_t centers = 0;  ///< contacts that carry the field
    double misfit = 0;         ///< the largest distance of a contact from its surface, nearly
    std::vector<std::int64_t> dips_missed;    ///< dips against which f falls
    std::vector<std::int64_t> bounds_missed;  ///< bounds that contradict other data
    /// Of each of these, those that count most for the field there.
    std::vector<std::vector<Datum>> contradicted;
    /// Of a field with ranges or an anisotropy the share of the lattice that each block, from the
    /// oldest, has with the best field that has none, unless this predicts data clearly worse.
    std::vector<double> plain_shares;
};

/// The smoothest field that honors the data: its third derivatives, integrated over all of space,
/// are least, or its second ones, where surfaces are so rough that it would else have critical
/// points (Duchon 1977), or all up to the fifth, where dips say that it is smoother, with a range
/// (Matern's covariance; Lajaunie, Courrioux and Manuel 1997 with others). On each
/// surface it has one value, which is free; along a dip's plane it does not change, and how fast it
/// rises across it is free, too: only the mean over all dips is given. Bounds, rising levels and
/// polarities are inequalities, met by active sets (Nocedal and Wright 2006, section 16.5).
///
/// Space is scaled along the fold axis, which dips have in common, and across it in the axial
/// plane, so that f bends less there: by those ratios under which the data are most likely
/// (restricted likelihood; Patterson and Thompson 1971, Kitanidis 1983). So is by how much each
/// fault has moved the rock on one side, along it: f is the smoothest where the rock was before.
///
/// Contacts that may be off are passed near by: values have errors under which the data are most
/// likely, and no smaller ones than these where f rises as in the mean.
///
/// Where beds keep their thickness it rises nearly as steeply along each of them (parallel folds):
/// contacts, dips and inequalities hold as before.
///
/// Of more contacts than the options allow those carry the field that it would miss most (Carr et
/// al. 2001, "Reconstruction and representation of 3D objects with radial basis functions").
///
/// A field that is drawn is a random function S, and the smoothest one that honors the data less
/// what S is there: S is conditioned by the data, with equalities by kriging (Chiles and Delfiner
/// 2012, section 7.3). Which data contradict one another is not asked again.
/// @return  the same bytes for any number of threads
/// @throws InputError kind "option", "not_finite", "outside" (items: contacts, dips or bounds, as
///         the message says), "no_contacts" (surface), "no_direction", "contradicting" (items: two
///         contacts), "wrong_order" (surface: the older; items: contacts), "against_order" (items:
///         most of the dips), "polarity" (items: the dip); Cancelled
Field solve_field(const Lattice& lattice, const FieldData& data, const FieldOptions& options,
                  const Execution& execution = {});

}  // namespace realmodel::fields
