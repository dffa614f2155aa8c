// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "simulation/column_fronts.hpp"
#include "simulation/face_quality.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_levels.hpp"

namespace realmodel::simulation {

/// Finds the elements that solvers do badly with, as OpenFOAM's checkMesh measures it, and what
/// mends them. Heights are read anew each time; fronts must stay.
class ElementQuality {
public:
    ElementQuality(const PlanTopology& plan, const PostLevels& levels, const ColumnFronts& columns,
                   double minimum_thickness, Progress* progress);

    double elements() const { return static_cast<double>(columns_.fronts.size()); }

    using Removals = std::vector<PostLevels::Removal>;

    /// Elements with inner faces in too few directions to compute a gradient with (their cell
    /// determinant), and those whose line to the center of the next element hardly crosses the face
    /// between the two. These are thin ends of layers. Their upright edges are given up, unless a
    /// block would lose much.
    /// @param is_narrow  narrow_strips()
    Removals weak(std::span<const std::uint8_t> is_narrow) const;

    /// The elements that checkMesh fails, whatever their blocks lose: too small a determinant, and
    /// one of two neighbors where the line between their centers crosses their face far from its
    /// center, or at more than 70 degrees from the direction across, or if one is much smaller.
    Removals failing(std::span<const std::uint8_t> is_narrow) const;

    /// Faces between elements and outside that are crossed farther from their centers than
    /// checkMesh allows, and the worst of them. Elements that are too thin for how steep they are
    /// there become one with the next in their columns (`removals`). At top and base they are too
    /// tall instead: `tall` has the blocks of these.
    struct Skewed {
        std::size_t faces = 0;
        double most = 0;
        Vec3 place{};
        std::vector<std::int32_t> tall;
        Removals removals;
    };
    /// @param divided  whether elements are divided into tetrahedra
    Skewed skewed(bool divided) const;

    /// Of each steep face that the line between the centers of its elements crosses at too small an
    /// angle: by how much its corners would move to make it less steep.
    /// @param is_asked  of each node: triangles without one are passed over
    std::vector<PostLevels::Move> steep(std::span<const std::uint8_t> is_asked) const;

private:
    static constexpr std::size_t kNone = SIZE_MAX;
    /// An element, or what is outside beside a triangle.
    struct Place {
        std::size_t triangle, element;
    };

    /// Where the corners of the elements over one triangle are, looked up once for all of them.
    struct Corners {
        std::array<Vec2, 3> plan;
        std::array<std::span<const double>, 3> heights;  ///< of each node

        Vec3 at(std::size_t corner, std::int32_t height) const {
            return {plan[corner][0], plan[corner][1], z(corner, height)};
        }
        double z(std::size_t corner, std::int32_t height) const {
            return heights[corner][static_cast<std::size_t>(height)];
        }
        Vec3 flat_area(const Front& front) const;
        ElementBody body(const Front& low, const Front& high) const;
    };

    Corners corners(std::size_t t) const;
    std::size_t moved_corners(std::size_t element) const;
    ElementBody body(const Corners& at, std::size_t element) const {
        return at.body(columns_.fronts[element], columns_.fronts[element + 1]);
    }
    std::vector<ElementBody> bodies() const;
    bool gives_upward(std::size_t t, std::size_t element) const;
    bool joins_upward(std::size_t t, std::size_t e) const;
    void give_up(std::size_t t, std::size_t element, bool upper, Removals& found) const;
    /// Calls visit(face, own, other) for each face; the other may be outside, own may not.
    template <class Visit>
    void for_faces(const Visit& visit) const;
    ColumnFronts tetrahedra(std::vector<std::size_t>& whole) const;
    void find_skewed(const ElementQuality& parts, std::span<const std::size_t> whole,
                     Skewed& found) const;
    bool leans_at(const Corners& at, std::size_t below, double cosine, bool steeper) const;
    double determinant(const Corners& at, std::size_t element, bool is_first, bool is_last,
                       unsigned open_sides) const;
    bool is_tall(const Corners& at, std::size_t element) const;
    bool shares_sides(std::size_t t, std::size_t edge) const;
    bool divides_blocks(std::size_t t, std::size_t corner, std::int32_t height) const;
    void add_spare(Removals& last, Removals& found) const;
    /// Calls visit(element, is_shared, beyond) for each upright side at one edge of a triangle:
    /// whether an element of the next column, `beyond`, has the same side.
    template <class Visit>
    void for_sides(std::size_t t, std::size_t edge, const Visit& visit) const;

    const PlanTopology& plan_;
    const PostLevels& levels_;
    const ColumnFronts& columns_;
    const double minimum_thickness_;
    Progress* progress_;
    std::vector<std::uint8_t> open_sides_;  ///< of each element: a bit for each edge, if outside
};

}  // namespace realmodel::simulation
