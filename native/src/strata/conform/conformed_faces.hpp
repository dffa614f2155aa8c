// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "strata/conform/collinear_edges.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// Where the entries of each corner are. Each corner of a face has one, and behind it there is one
/// for each plan vertex that the edge passes which leaves the corner. Few edges pass any, so only
/// these are stored: an offset is found within a short block of corners.
class CornerOffsets {
public:
    CornerOffsets() = default;
    /// @throws InputError kind too_large, where there are more entries than can be numbered
    CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners,
                  const Execution& execution);

    /// The first entry of a corner. Of the number of corners: how many entries there are.
    std::uint32_t first(std::size_t corner) const { return entries(corner)[0]; }
    /// The first entry of a corner, and the first of the next one.
    std::array<std::uint32_t, 2> entries(std::size_t corner) const {
        std::uint32_t entry = near(corner);
        const std::size_t block = corner / kBlock;
        const Passing* at = passing_.values.begin() + passing_.offsets[block];
        const Passing* const end = passing_.values.begin() + passing_.offsets[block + 1];
        for (; at != end && at->corner < corner; ++at)
            entry += at->vertices;
        const bool passes = at != end && at->corner == corner;
        return {entry, entry + 1 + (passes ? at->vertices : 0)};
    }
    /// An entry somewhat before those of a corner, of which memory may be asked for.
    std::uint32_t near(std::size_t corner) const {
        return entry_of_block_[corner / kBlock] + static_cast<std::uint32_t>(corner % kBlock);
    }
    /// Calls visit(corner, first entry) for a range of corners.
    template <class Visit>
    void for_each(std::size_t begin, std::size_t end, const Visit& visit) const {
        const Passing* next = passing_.values.begin() + passing_.offsets[begin / kBlock];
        while (next != passing_.values.end() && next->corner < begin)
            ++next;
        std::uint32_t entry = first(begin);
        for (std::size_t corner = begin; corner < end; ++corner) {
            visit(corner, entry++);
            if (next != passing_.values.end() && next->corner == corner)
                entry += (next++)->vertices;
        }
    }
    /// To be called some time before first(): the memory is fetched meanwhile.
    [[gnu::always_inline]] void prefetch(std::size_t corner) const {
        realmodel::prefetch(&entry_of_block_[corner / kBlock]);
        realmodel::prefetch(&passing_.offsets[corner / kBlock]);
    }
    std::size_t corners() const { return corners_; }

private:
    static constexpr std::size_t kBlock = 32;  // corners
    /// An edge that passes plan vertices.
    struct Passing {
        std::uint32_t corner, vertices;
        friend auto operator<=>(const Passing&, const Passing&) = default;
    };

    std::size_t corners_ = 0;
    Array<std::uint32_t> entry_of_block_;  ///< the first of each block
    Buckets<Passing> passing_;             ///< of each block, in order of corners
};

/// A vertex on an edge that has no entry for it: it follows a given entry.
struct InsertedVertex {
    std::uint32_t entry;
    std::int32_t vertex;
};

/// The faces with every vertex that lies on their edges put in, and all vertices: on each plan
/// vertex one for each height that a corner or an edge needs there, ascending.
struct ConformedFaces {
    Array<std::uint32_t> face_offsets;  ///< entries of each face
    CornerOffsets entries;              ///< of each corner
    /// Of each entry, counter-clockwise in plan; -1 where an edge passes a plan vertex tentatively
    /// and nothing else is as high there.
    Array<std::int32_t> vertices;
    std::vector<InsertedVertex> inserted;  ///< in order of entries
    Array<std::int32_t> vertex_offsets;    ///< first vertex of each plan vertex
    /// Of the vertices, for so many plan vertices each: rounded, those of a plan vertex all
    /// different.
    std::vector<std::vector<double>> heights;
    static constexpr std::size_t kVertexGrain = 1 << 11;
    Array<std::array<double, 3>> positions;  ///< empty until set_vertex_positions

    std::size_t plan_vertex_of(std::int32_t vertex) const {
        const auto next = std::upper_bound(vertex_offsets.begin(), vertex_offsets.end(), vertex);
        return static_cast<std::size_t>(next - vertex_offsets.begin()) - 1;
    }
};
/// Takes what it needs of the lines: what they have `passed` is given back, and their edges name
/// the first of their entries from here on.
/// @param points  the faces', to be given back as soon as entries have their plan vertices
ConformedFaces conform_faces(const exact::PlanArrangement& geometry, const FaceList& faces,
                             const PlanVertices& plan_vertices, CollinearEdges& collinear,
                             const Execution& execution, Array<PointId>* points = nullptr);

/// Points where the corners of conformed faces are.
Array<PointId> points_of_corners(const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                                 const Execution& execution);

/// Gives the vertices their positions, which takes the heights.
void set_vertex_positions(const PlanVertices& plan_vertices, ConformedFaces& conformed,
                          const Execution& execution);

/// A plane as a number, which is below 0 where it is tentative.
inline std::int32_t code_of(PlaneId plane, bool is_tentative) {
    return is_tentative ? ~plane.number() : plane.number();
}
inline bool is_tentative(std::int32_t code) {
    return code < 0;
}
inline PlaneId plane_of(std::int32_t code) {
    return PlaneId(code < 0 ? ~code : code);
}

/// The different heights of planes at one plan vertex, ascending. Planes that are known to be
/// equally high there by what the plan vertex is made of share a name and are asked once; rounded
/// heights keep the order of the others, and where they are equal, the exact test decides.
class VertexHeights {
public:
    explicit VertexHeights(const exact::PlanArrangement& geometry) : scope_(geometry) {}

    /// Finds the heights of planes above a point.
    /// @param planes  code_of each of them; in its stead comes which of the heights it has.
    ///     Tentative ones make no height, but take up that of another plane which is as high, and
    ///     where they are so near to one that rounding could make a difference they count like the
    ///     others. What takes up none gets -1.
    void find(PointId point, std::span<std::int32_t> planes);

    /// The heights, rounded, each a different double. Where several round to one, those that are
    /// doubles themselves keep theirs (what is level, as a flat base, stays so) and the others move
    /// to the next ones.
    const std::vector<double>& heights() const { return heights_; }

private:
    /// Planes that are known to be equally high.
    struct HeightLevel {
        exact::HeightName name;
        PlaneId plane;  ///< one of them
        double z;
        std::int32_t rank;
    };
    struct LeveledPlane {
        PlaneId plane;
        std::int32_t level;
    };

    bool find_single(PointId point, std::span<std::int32_t> planes);
    std::int32_t level_of(PointId point, PlaneId plane);
    void find_distinct(PointId point, std::span<const std::int32_t> planes);
    void rank_levels(PointId point);
    void settle_tentative(PointId point);
    bool is_near(PointId point, PlaneId plane, std::span<const HeightLevel> levels) const;
    std::int32_t rank_of(PlaneId plane) const;
    bool is_double(std::size_t rank) const;
    void separate();

    LocalArrangement scope_;
    std::vector<LeveledPlane> planes_;     ///< each once, ascending
    std::vector<LeveledPlane> tentative_;  ///< each once; without a level until they take up one
    std::vector<HeightLevel> levels_;
    std::vector<std::int32_t> order_;  ///< of the levels, ascending
    std::vector<double> heights_;
};

}  // namespace realmodel::strata
