// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cutting/exact_points.hpp"
#include "exact/arithmetic.hpp"
#include "exact/fixed_integer.hpp"

namespace realmodel::cutting {

/// Points as whole numbers of fixed width, for one question: places over weights, relative to an
/// origin, in units of the finest of the doubles that they were made of. Points given by fractions
/// are not known.
class ExactPoints::Wide {
public:
    using Integer = exact::FixedInteger;
    struct Place {
        std::array<Integer, 3> at;
        Integer weight;
        bool is_whole = true;  ///< the weight is 1
    };

    Wide(const ExactPoints& points, std::span<const NodeId> asked) : points_(points) {
        for (const NodeId p : asked)
            include(p);
    }
    Wide(const ExactPoints& points, const Crossing& crossing) : points_(points) {
        for (const NodeId p : crossing.of)
            include(p);
    }

    Place place(NodeId p) const {
        if (const Made* made = points_.made(p)) return place(made->crossing);
        Place place;
        place.at = points_.is_double(p) ? minus(points_.rounded(p), origin_) : unknown();
        return place;
    }
    Place place(const Crossing& crossing) const {
        const auto [p, q, a, b, c] = crossing.of;
        const auto from = [&](NodeId node, NodeId o) {
            return minus(points_.rounded(node), points_.rounded(o));
        };
        const auto u = from(b, a), v = from(c, a), start = from(p, a), way = from(q, p);
        const std::array normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                u[0] * v[1] - u[1] * v[0]};
        const auto dot = [&normal](const std::array<Integer, 3>& w) {
            return normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        };
        const Integer share = dot(start);
        Place place;
        place.is_whole = false;
        place.weight = dot(way);
        const auto first = minus(points_.rounded(p), origin_);
        for (std::size_t k = 0; k < 3; ++k)
            place.at[k] = first[k] * place.weight - share * way[k];
        return place;
    }
    /// A point's place where another is the origin.
    static std::array<Integer, 3> from_other(const Place& p, const Place& other) {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = times(p.at[k], other) - times(other.at[k], p);
        return result;
    }
    static Integer times(const Integer& number, const Place& place) {
        return place.is_whole ? number : number * place.weight;
    }
    static int sign_of_weight(const Place& place) {
        return place.is_whole ? 1 : sign_of(place.weight);
    }
    std::optional<int> orientation(const std::array<NodeId, 4>& points) const;
    std::optional<int> turn(std::size_t axis, const std::array<NodeId, 3>& points) const;
    std::optional<int> compare(std::size_t axis, NodeId a, NodeId b) const;
    /// Whether a crossing is exactly where its doubles are; nothing where that is not known.
    std::optional<bool> is_at(const Crossing& crossing, const Position& doubles) {
        for (const double x : doubles)
            unit_ = exact::finest_exponent(x, unit_);
        const Place found = place(crossing);
        const auto at = minus(doubles, origin_);
        bool is_equal = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Integer off = times(at[k], found) - found.at[k];
            if (!is_known(off)) return std::nullopt;
            is_equal = is_equal && sign_of(off) == 0;
        }
        return is_equal;
    }

private:
    static std::size_t simplest(std::span<const Place> places);
    void include(NodeId p) {
        if (const Made* made = points_.made(p)) {
            for (const NodeId node : made->crossing.of)
                include(node);
            return;
        }
        if (!points_.is_double(p)) return;
        if (!has_origin_) origin_ = points_.rounded(p);
        has_origin_ = true;
        for (const double x : points_.rounded(p))
            unit_ = exact::finest_exponent(x, unit_);
    }
    std::array<Integer, 3> minus(const Position& p, const Position& q) const {
        std::array<Integer, 3> result;
        for (std::size_t k = 0; k < 3; ++k)
            result[k] = Integer::of(p[k], unit_) - Integer::of(q[k], unit_);
        return result;
    }
    static std::array<Integer, 3> unknown() {
        return {Integer::unknown(), Integer::unknown(), Integer::unknown()};
    }

    const ExactPoints& points_;
    Position origin_{0, 0, 0};
    bool has_origin_ = false;
    int unit_ = 1024;
};

}  // namespace realmodel::cutting
