// SPDX-License-Identifier: GPL-3.0-or-later
// What OpenFOAM's checkMesh measures of elements and their faces, and what mends them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "realmodel/base/progress.hpp"
#include "simulation/columns.hpp"
#include "simulation/pillar_levels.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

// Its limits, or a little within them.
inline constexpr double kWeakDeterminant = 0.0011;  ///< of a cube it is 1; its limit is 0.001
inline constexpr double kMostLean = 0.36;           ///< cosine of 69 degrees; its limit is 70
inline constexpr double kSkewnessLimit = 4;         ///< without any option
inline constexpr double kMostSkewness = 3.8;        ///< what is repaired
inline constexpr double kLeastWeight = 0.052;       ///< its limit is 0.05
inline constexpr double kLeastShare = 0.0105;       ///< of a neighbor's volume; its limit is 0.01

/// A face of an element, of three or four corners (of three one is twice there).
struct ElementFace {
    std::array<Vec3, 4> corners;
    Vec3 area, center;
};
struct ElementBody {
    Vec3 center;
    double volume;
};

/// The side of a column between heights `low` and `high` at points a and b of the plan.
ElementFace lateral_face(const Vec2& a, const Vec2& b, const std::array<double, 2>& low,
                         const std::array<double, 2>& high);

/// How far from its center a face is crossed by the line between the centers of its elements: 1 is
/// the edge of the face. 0 where it is clearly less than kMostSkewness.
double inner_skewness(const ElementFace& face, const Vec3& center, const Vec3& other);
/// The same at the outside, where the line is upright on the face.
double outer_skewness(const ElementFace& face, const Vec3& center);
/// Whether checkMesh fails a face between two elements: for the angle of the line between their
/// centers, where this crosses the face, or their sizes.
bool is_bad(const ElementFace& face, const ElementBody& body, const ElementBody& other);

/// The determinant of the sum of n n^T over the inner faces of an element, by eight (n: the normal,
/// as long as the area over the mean area). It is 0 where these face in two directions only.
double determinant_of(std::span<const Vec3> areas);

/// Finds the elements that solvers do badly with, as OpenFOAM's checkMesh measures it, and what
/// mends them. Heights are read anew each time; fronts must stay.
class ElementQuality {
public:
    ElementQuality(const PlanTopology& plan, const PillarLevels& levels,
                   const ColumnFronts& columns, double minimum_thickness, Progress* progress);

    double elements() const { return static_cast<double>(columns_.fronts.size()); }

    using Removals = std::vector<PillarLevels::Removal>;

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
    struct SkewedFaces {
        std::size_t faces = 0;
        double most = 0;
        Vec3 place{};
        std::vector<std::int32_t> tall;
        Removals removals;
    };
    /// @param divided  whether elements are divided into tetrahedra
    SkewedFaces skewed(bool divided) const;

    /// Of each steep face that the line between the centers of its elements crosses at too small an
    /// angle: by how much its corners would move to make it less steep.
    /// @param is_asked  of each node: triangles without one are passed over
    std::vector<PillarLevels::Move> steep(std::span<const std::uint8_t> is_asked) const;

private:
    static constexpr std::size_t kNone = SIZE_MAX;
    /// An element, or what is outside beside a triangle.
    struct ElementRef {
        std::size_t triangle, element;
    };

    /// Where the corners of the elements over one triangle are, looked up once for all of them.
    struct ColumnCorners {
        std::array<Vec2, 3> plan;
        std::array<std::span<const double>, 3> heights;  ///< of each node

        Vec3 at(std::size_t corner, std::int32_t height) const {
            return {plan[corner][0], plan[corner][1], z(corner, height)};
        }
        double z(std::size_t corner, std::int32_t height) const {
            return heights[corner][static_cast<std::size_t>(height)];
        }
        Vec3 flat_area(const LevelFront& front) const;
        ElementBody body(const LevelFront& low, const LevelFront& high) const;
    };

    ColumnCorners corners(std::size_t t) const;
    std::size_t moved_corners(std::size_t element) const;
    ElementBody body(const ColumnCorners& at, std::size_t element) const {
        return at.body(columns_.fronts[element], columns_.fronts[element + 1]);
    }
    std::vector<ElementBody> bodies() const;
    bool joins_upward(std::size_t t, std::size_t e) const;
    void give_up(std::size_t t, std::size_t element, bool upper, Removals& removals) const;
    /// Calls visit(face, owner, other) for each face; the other may be outside, the owner may not.
    template <class Visit>
    void for_faces(const Visit& visit) const;
    ColumnFronts tetrahedra(std::vector<std::size_t>& whole) const;
    void find_skewed(const ElementQuality& tetrahedra_quality, std::span<const std::size_t> whole,
                     SkewedFaces& skewed) const;
    bool leans_at(const ColumnCorners& at, std::size_t below, double cosine, bool steeper) const;
    double determinant(const ColumnCorners& at, std::size_t element, bool is_first, bool is_last,
                       unsigned open_edges) const;
    bool is_tall(const ColumnCorners& at, std::size_t element) const;
    bool shares_lateral_faces(std::size_t t, std::size_t edge) const;
    bool divides_blocks(std::size_t t, std::size_t corner, std::int32_t height) const;
    /// Calls visit(element, is_shared, beyond) for each upright side at one edge of a triangle:
    /// whether an element of the next column, `beyond`, has the same side.
    template <class Visit>
    void for_lateral_faces(std::size_t t, std::size_t edge, const Visit& visit) const;

    const PlanTopology& plan_;
    const PillarLevels& levels_;
    const ColumnFronts& columns_;
    const double minimum_thickness_;
    Progress* progress_;
    std::vector<std::uint8_t> open_edges_;  ///< of each element: a bit for each edge, if outside
};

}  // namespace realmodel::simulation
