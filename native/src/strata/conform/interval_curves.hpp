// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "strata/conform/conformed_faces.hpp"

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

/// Calls visit(low, high, left, right) for each two neighboring heights of an interval: a curve at
/// either, and what lies between the two left and right of the line.
/// @param are_columns  cells are columns, some of which may be left out; else all nodes are there
template <class Visit>
void for_each_gap(std::span<const IntervalCurve> curves, bool are_columns, const Visit& visit) {
    std::array beside{below_all(curves, false), below_all(curves, true)};  // right, left
    if (are_columns) beside.fill(curves[0].below);
    for (std::size_t i = 0; i < curves.size();) {
        // Where another column is below a curve than was above the last one on that side, a face in
        // between goes on across the line, and so do the columns that it separates.
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

}  // namespace realmodel::strata
