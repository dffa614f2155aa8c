// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "strata/conform/collinear_edges.hpp"
#include "strata/conform/conformed_faces.hpp"
#include "strata/overlay/border_edges.hpp"
#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// A face edge over one interval of a line: a straight line in height between two verticals.
struct IntervalCurve {
    std::int32_t start, end;  ///< vertices on the two verticals; ascending means rising
    std::int32_t face;
    std::int32_t above, below;  ///< what the face lies between: cells, or nodes
    bool left;                  ///< the face lies left of the line

    bool as_high_as(const IntervalCurve& other) const {
        return start == other.start && end == other.end;
    }
};

/// The face edges of one line after another: what stands on its two sides.
class IntervalCurves {
public:
    IntervalCurves(const FaceList& faces, const CollinearEdges& collinear,
                   const ConformedFaces& conformed)
        : faces_(faces), collinear_(collinear), conformed_(conformed) {}

    /// Puts the curves of a line in order of intervals, and those of each in order of height.
    void collect(std::size_t number);
    std::size_t intervals() const { return begins_.empty() ? 0 : begins_.size() - 1; }
    std::span<const IntervalCurve> of_interval(std::size_t i) const {
        return {curves_.data() + begins_[i], begins_[i + 1] - begins_[i]};
    }

    /// The points where curves of an interval cross in height, which the line must pass first.
    void find_crossings(std::size_t number, std::span<const IntervalCurve> curves,
                        LocalArrangement& scope, std::vector<ExtraPoint>& missing) const;

private:
    bool before(const IntervalCurve& a, const IntervalCurve& b) const;
    void add_curves(const LineEdge& edge);
    void prefetch_edge(const LineEdge* edge) const;

    const FaceList& faces_;
    const CollinearEdges& collinear_;
    const ConformedFaces& conformed_;
    std::vector<IntervalCurve> curves_;
    std::vector<std::uint32_t> begins_, free_;  ///< curves of each interval, and where more go
};

/// What is below the lowest curve on one side; kOutsideCell where that has none.
std::int32_t below_all(std::span<const IntervalCurve> curves, bool left);

/// Calls visit(low, high, left, right) for each two neighboring heights of an interval: a curve
/// at either, and what lies between the two left and right of the line.
/// @param are_columns  cells are columns, some of which may be left out; else all nodes are
/// there
template <class Visit>
void for_each_gap(std::span<const IntervalCurve> curves, bool are_columns, const Visit& visit) {
    std::array beside{below_all(curves, false), below_all(curves, true)};  // right, left
    if (are_columns) beside.fill(curves[0].below);
    for (std::size_t i = 0; i < curves.size();) {
        // Where another column is below a curve than was above the last one on that side, a
        // face in between goes on across the line, and so do the columns that it separates.
        if (are_columns && curves[i].below != beside[curves[i].left ? 1 : 0])
            beside.fill(curves[i].below);
        std::size_t level = i;  // past the curves at this height
        for (; level < curves.size() && curves[level].as_high_as(curves[i]); ++level)
            beside[curves[level].left ? 1 : 0] = curves[level].above;
        if (level == curves.size()) break;
        visit(curves[i], curves[level], beside[1], beside[0]);
        i = level;
    }
}

/// Some of the vertical faces between cells. Loops counter-clockwise seen from the right of
/// their line.
struct WallBatch {
    std::vector<std::int32_t> sizes;  ///< corners of each wall
    std::vector<std::int32_t> vertices;
    std::vector<std::array<std::int32_t, 2>> cells;  ///< left and right of the line, -1 outside

    /// Adds a wall: along its lower vertices, up the far vertical, back along the upper ones
    /// and down the near vertical, through every vertex on them that is to be kept.
    template <class Keep>
    void add(std::span<const std::int32_t> lower, std::span<const std::int32_t> upper,
             const std::array<std::int32_t, 2>& beside, const Keep& holds) {
        const std::size_t before = vertices.size();
        const auto pass = [&](std::int32_t v) {
            if (holds(v)) vertices.push_back(v);
        };
        for (const std::int32_t v : lower)
            pass(v);
        for (std::int32_t v = lower.back() + 1; v < upper.back(); ++v)
            pass(v);
        const std::size_t last = upper.back() == lower.back() ? upper.size() - 1 : upper.size();
        const std::size_t first = upper.front() == lower.front() ? 1 : 0;
        for (std::size_t i = last; i-- > first;)
            pass(upper[i]);
        for (std::int32_t v = upper.front() - 1; v > lower.front(); --v)
            pass(v);
        sizes.push_back(static_cast<std::int32_t>(vertices.size() - before));
        cells.push_back(beside);
    }
};

/// A wall that may go on in the next interval of its line.
struct OpenWall {
    std::int32_t left = kOutsideCell, right = kOutsideCell;
    std::vector<std::int32_t> lower, upper;  ///< vertices along the line
};

/// Joins walls of neighboring intervals of one line: those between the same cells are one face
/// where they share a whole vertical edge, which would bound nothing.
class WallJoining {
public:
    /// Adds a wall over the present interval.
    /// @param lower, upper  its vertices at the beginning of the interval and at the end
    /// @param may_join  whether its first vertical edge is one that walls may be joined at
    void add(const std::array<std::int32_t, 2>& lower, const std::array<std::int32_t, 2>& upper,
             std::int32_t left, std::int32_t right, bool may_join) {
        OpenWall* before =
            !may_join ? open_.end()
                      : std::find_if(open_.begin(), open_.end(), [&](const OpenWall& wall) {
                            return wall.left == left && wall.right == right &&
                                   wall.lower.back() == lower[0] && wall.upper.back() == upper[0];
                        });
        OpenWall& wall = growing_.add();
        if (before == open_.end()) {
            wall.left = left;
            wall.right = right;
            wall.lower.assign(lower.begin(), lower.end());
            wall.upper.assign(upper.begin(), upper.end());
            return;
        }
        std::swap(wall, *before);
        std::rotate(before, before + 1, open_.end());
        --open_.count;
        wall.lower.push_back(lower[1]);
        wall.upper.push_back(upper[1]);
    }
    /// Ends an interval; calls emit(wall) with walls that did not go on in it.
    template <class Emit>
    void end_interval(const Emit& emit) {
        end_line(emit);
        std::swap(open_, growing_);
    }
    /// Calls emit(wall) with the walls that are open still.
    template <class Emit>
    void end_line(const Emit& emit) {
        for (const OpenWall& wall : open_)
            emit(wall);
        open_.count = 0;
    }

private:
    /// Walls that keep their memory when they are removed.
    struct OpenWalls {
        std::vector<OpenWall> all;
        std::size_t count = 0;

        OpenWall& add() {
            if (count == all.size()) all.emplace_back();
            return all[count++];
        }
        OpenWall* begin() { return all.data(); }
        OpenWall* end() { return all.data() + count; }
    };

    OpenWalls open_, growing_;
};

/// A stretch of vertical face between two neighboring plan vertices of a line, with nodes of
/// different blocks on its sides.
struct WallStretch {
    std::int32_t line, interval;
    std::array<std::int32_t, 2> lower,
        upper;                 ///< vertices at the first plan vertex and the second
    std::int32_t left, right;  ///< nodes, or kOutsideCell
};

/// What is asked besides where nodes become the cells of blocks.
struct BlockLines {
    const Array<std::int32_t>& node_block;
    const PlanVertices& plan_vertices;
    const BorderEdges& borders;
};

/// What was found on lines.
struct WallLists {
    /// Points that lines must pass first, where columns left and right of one cross in height;
    /// then there is nothing else.
    std::vector<ExtraPoint> missing;
    std::vector<WallBatch> walls;        ///< between columns, in order of lines, matched edges last
    std::vector<WallStretch> stretches;  ///< between nodes of blocks, in order of line and interval
    std::vector<std::pair<std::int32_t, std::int32_t>> links;  ///< nodes of one block that touch
};

/// Finds the walls between columns, or where `blocks` are given the walls between different
/// blocks and the nodes that are connected. Where a border runs along a line all faces on both
/// its sides are there, and what is between them is compared; elsewhere a face goes on beyond
/// the line as it is, and so do the nodes above and below it. If nothing is missing, the
/// matched edges are given back on the way.
WallLists find_walls(exact::PlanArrangement& geometry, const FaceList& faces,
                     CollinearEdges& collinear, const ConformedFaces& conformed,
                     const BlockLines* blocks, const Execution& execution);

}  // namespace realmodel::strata
