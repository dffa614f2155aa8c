// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "polygons.hpp"

namespace realmodel::cutting {

/// Points of space, each known exactly, equal ones once. Signs are told by floating point where its
/// error bound allows it, else by fractions.
class ExactPoints {
public:
    using Fractions = std::array<mpq_class, 3>;

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
    struct Crossing {
        std::array<NodeId, 5> of;  ///< ends of the line, corners of the plane
        auto operator<=>(const Crossing&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Position& p) const;
    };
    NodeId enter(const Position& rounded, std::unique_ptr<Fractions> exact);
    struct CrossingHash {
        std::size_t operator()(const Crossing& c) const;
    };
    /// What is known, or else made of the doubles into `own`.
    const Fractions& exact(NodeId p, Fractions& own) const;
    double slack(NodeId a, NodeId b, NodeId c, NodeId d) const;
    bool is_double(NodeId p) const {
        return exact_[index(p)] == nullptr && made_of_[index(p)] == nullptr;
    }
    bool is_same(NodeId p, const Position& rounded, const Fractions* exact) const;
    std::optional<Position> rounded_crossing(const Crossing& crossing) const;
    Fractions exact_crossing(const Crossing& crossing) const;

    std::vector<Position> rounded_;
    /// None where the doubles are exact. Of crossings they are computed when they are asked for:
    /// most are told apart from everything by their doubles. (Crossings are made and asked by one
    /// thread.)
    mutable std::vector<std::unique_ptr<Fractions>> exact_;
    std::vector<std::unique_ptr<Crossing>> made_of_;
    std::unordered_multimap<Position, NodeId, Hash> known_;
    std::unordered_map<Crossing, NodeId, CrossingHash> crossings_;
};

}  // namespace realmodel::cutting
