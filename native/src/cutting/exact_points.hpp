// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cutting/fractions.hpp"
#include "cutting/node_table.hpp"
#include "cutting/polygons.hpp"
#include "exact/double_double_interval.hpp"

namespace realmodel::cutting {

/// Points of space, each known exactly, equal ones once.
///
/// Signs are told by doubles where their error bound allows it, by the names that points were made
/// of, by twice the precision of doubles, by whole numbers of fixed width, and only then by
/// fractions. What asks may be called from several threads, what adds points from one.
class ExactPoints {
public:
    /// Where a line passes through a plane: ends of the line, corners of the plane, both ascending.
    struct Crossing {
        std::array<NodeId, 5> of;
        bool operator==(const Crossing&) const = default;
        bool is_on_line(NodeId a, NodeId b) const { return of[0] == a && of[1] == b; }
        bool is_on_plane_of(const Crossing& c) const {
            return of[2] == c.of[2] && of[3] == c.of[3] && of[4] == c.of[4];
        }
    };

    /// The number of a point given by doubles.
    NodeId add(const Position& p);
    /// The number of a point given by fractions.
    NodeId add(Fractions&& p);

    std::size_t size() const { return rounded_.size(); }
    /// The doubles nearest to the point.
    const Position& rounded(NodeId p) const { return rounded_[index(p)]; }
    Fractions exact(NodeId p) const;
    /// Whether a point is known to lie on the line through a and b, as it was made there.
    bool was_made_on(NodeId p, NodeId a, NodeId b) const;

    /// Which side of the plane of a, b, c has d: 1 where a, b, c turn counter-clockwise seen from
    /// d, -1 the other, 0 on it.
    int orientation(NodeId a, NodeId b, NodeId c, NodeId d) const;
    /// Which way a, b, c turn in the view along `axis` from above: 1 left, -1 right, 0 straight on.
    int turn(std::size_t axis, NodeId a, NodeId b, NodeId c) const;
    /// Points on a line are in this order along it, or against it.
    int compare(NodeId a, NodeId b) const;
    int compare(std::size_t axis, NodeId a, NodeId b) const;

    /// Where the line through p and q passes through the plane of a, b and c, which it does.
    NodeId crossing(NodeId p, NodeId q, NodeId a, NodeId b, NodeId c);
    /// Where the line through p and q passes through the one through a and b, in the view along
    /// `axis`; all four lie in one plane.
    NodeId crossing(std::size_t axis, NodeId p, NodeId q, NodeId a, NodeId b);
    /// The point of a plane straight below or above p, seen along `axis`.
    NodeId dropped(std::size_t axis, NodeId p, NodeId a, NodeId b, NodeId c);
    /// The point of the line through a and b that has p's coordinate `axis`.
    NodeId dropped(std::size_t axis, NodeId p, NodeId a, NodeId b);

    /// Whether a ray from p in the direction of `axis` passes a triangle: 1 where that turns left
    /// seen from where the ray goes to, -1 where it turns right, 0 where it is passed by. A
    /// triangle that p lies on is passed where `from_below`: p is then just before it. Of triangles
    /// that share an edge the ray passes the same as one a little beside it would.
    int ray_passes(std::size_t axis, NodeId p, const std::array<NodeId, 3>& corners,
                   bool from_below) const;
    /// The middle of three points.
    NodeId middle(const std::array<NodeId, 3>& corners);
    /// Whether p is farther than q from the line through a and b, in the view along `axis`; both
    /// are on one side of it.
    bool is_farther(std::size_t axis, NodeId a, NodeId b, NodeId p, NodeId q) const;

private:
    /// A crossing of what is given by doubles, and its coordinates to twice their precision.
    struct Made {
        Crossing crossing;
        std::array<exact::DoubleDoubleInterval, 3> at;
    };
    /// What a point is known by: its doubles, a crossing of `made_`, or one of `fractions_`.
    struct Source {
        enum class Kind : std::uint8_t { kDoubles, kMade, kFractions } kind = Kind::kDoubles;
        std::int32_t number = 0;
    };

    NodeId enter(const Position& rounded, Source source);
    NodeId make(const Crossing& crossing);
    NodeId find_equal(NodeId p) const;
    bool is_double(NodeId p) const { return source_[index(p)].kind == Source::Kind::kDoubles; }
    const Made* made(NodeId p) const {
        const Source& source = source_[index(p)];
        return source.kind == Source::Kind::kMade ? &made_[index(source.number)] : nullptr;
    }
    std::array<exact::DoubleDoubleInterval, 3> place(const Crossing& crossing) const;
    Fractions exact_crossing(const Crossing& crossing) const;

    double slack(NodeId a, NodeId b, NodeId c, NodeId d) const;
    bool lie_on_one_plane_by_name(const std::array<NodeId, 4>& points) const;
    bool lie_on_one_line_by_name(const std::array<NodeId, 3>& points) const;
    /// A coordinate to twice the precision of doubles; nothing of points given by fractions.
    std::optional<exact::DoubleDoubleInterval> ball(NodeId p, std::size_t axis) const;
    std::optional<int> orientation_of_balls(const std::array<NodeId, 4>& points) const;
    std::optional<int> turn_of_balls(std::size_t axis, const std::array<NodeId, 3>& points) const;
    class Wide;  ///< places as whole numbers of fixed width

    std::vector<Position> rounded_;
    std::vector<Source> source_;
    std::vector<Made> made_;
    std::vector<Fractions> fractions_;
    NodeTable known_;      ///< points by their doubles
    NodeTable crossings_;  ///< places in crossing_names_, by name
    std::vector<std::pair<Crossing, NodeId>> crossing_names_;
};

}  // namespace realmodel::cutting
