// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/triangle_view.hpp"

namespace realmodel::structures {

/// A fault, an open surface, or a body, a closed one (docs/dev/structures.md).
struct Structure {
    TriangleView surface;
    bool is_body = false;
    std::vector<std::int32_t> ends_at = {};  ///< of a fault: the faults that it ends at
    bool dies_out = false;                   ///< a fault that ends in the rock
};

/// The side of each structure that something is on: 1 above a fault or outside of a body, -1 below
/// or inside, 0 where there is no such structure: beyond a fault that it ends at.
using Sides = std::vector<std::int8_t>;

/// A compartment that structures leave, within some rock.
struct Compartment {
    Sides sides;
    std::array<double, 3> low, high;  ///< a box around it
};

/// The compartments that structures divide the rock in a box (two corners) into, each combination
/// of sides once, ascending.
/// @throws InputError  `surface` is the structure's number; kinds not_finite, bad_index,
///         no_triangles, branching, one_sided; not_closed (of a body: the place of an open edge);
///         does_not_meet (a fault and one that it ends at, which it does not meet); equal_halves
///         (one that a fault it ends at cuts into two parts of one area); folded (one that dies
///         out, whose border crosses itself seen at right angles to its mean plane)
/// @throws Cancelled
std::vector<Compartment> compartments_of(const std::array<std::array<double, 3>, 2>& corners,
                                         std::span<const Structure> structures,
                                         const Execution& execution);

/// A structure with what continues it beyond its border, found once for models that are joined
/// piece by piece: each piece has the triangles near it.
struct ContinuedStructure {
    std::vector<std::array<std::array<double, 3>, 3>> triangles;
    std::vector<std::uint8_t> is_continuation;  ///< of triangles
    std::vector<std::int8_t> end_sides;  ///< of a fault: the side of each it ends at where it is
};

/// All structures as join_models continues them for rock in a box (two corners).
/// @throws InputError  as compartments_of does
std::vector<ContinuedStructure> continued_structures(
    std::span<const Structure> structures, const std::array<std::array<double, 3>, 2>& corners);

/// What the rock is in one of the compartments, though its cells may reach beyond it.
struct CompartmentModel {
    ComplexView model;
    Sides sides;  ///< 0: on either side, or where there is none
};

/// Cells of several models, each in its compartment alone, that share faces where compartments
/// meet.
struct Joined {
    CellComplex complex;
    std::vector<std::int32_t> cell_compartment;  ///< the model of each cell, or of its first
};

/// Cuts each model by the structures around its compartment and joins what is left. Faces on a
/// structure have its number, counted after all surfaces. Where no structure acts the cells on both
/// sides are one. Decisions are exact on the models' coordinates and the structures'; coordinates
/// are rounded once.
/// @param models  none overlaps another within one compartment; of several that a compartment's
///                sides allow the first counts
/// @param acts    S x B: whether a structure divides a block of the models
/// @param continued  of each structure, as continued_structures has them; none: they are continued
///                   as far as these models reach
/// @param largest  the largest coordinate of the whole that these models are a piece of, which says
///                 how coarse rounding is; 0: theirs says
/// @throws InputError  as compartments_of does; kinds bad_model; ends_inside (a fault, and the
///                     place where it ends though the rock on both sides differs)
/// @throws Cancelled
Joined join_models(std::span<const CompartmentModel> models, std::span<const Structure> structures,
                   std::span<const std::uint8_t> acts, const Execution& execution,
                   std::span<const ContinuedStructure> continued = {}, double largest = 0);

/// A structure that is made ready once, and asked many times on which side points are.
class PreparedStructure {
public:
    /// @param structures  the structure, then the faults that it ends at
    /// @throws InputError  as compartments_of does
    explicit PreparedStructure(std::span<const Structure> structures);
    ~PreparedStructure();

    /// The side that points are on: of a fault that of the triangle nearest to each, of a body by
    /// the number of times that a ray from there leaves it. A point on it is above, or outside.
    /// @throws InputError  as compartments_of does
    std::vector<std::int8_t> sides(std::span<const std::array<double, 3>> points,
                                   const Execution& execution) const;

private:
    class Cutters;
    std::unique_ptr<const Cutters> cutters_;
};

/// Which triangles of a sheet a fault's continuation beyond its border may touch, 1, or pass, 2,
/// wherever the sheet lies between two heights: none too few, perhaps some too many.
/// @param faults  the fault, then those that it ends at
/// @param low, high  3 N coordinates of its vertices, equal in plan
/// @param triangles  3 T
/// @throws InputError  as compartments_of does
std::vector<std::uint8_t> triangles_beyond(std::span<const Structure> faults,
                                           std::span<const double> low,
                                           std::span<const double> high,
                                           std::span<const std::int32_t> triangles,
                                           const Execution& execution);

/// The triangles by which a fault is continued beyond its border, farther than a box around the
/// rock (two corners) reaches.
/// @param faults  the fault, then those that it ends at
/// @throws InputError  as compartments_of does
std::vector<std::array<std::array<double, 3>, 3>> continuation_of(
    std::span<const Structure> faults, const std::array<std::array<double, 3>, 2>& corners);

}  // namespace realmodel::structures
