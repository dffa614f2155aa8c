// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/plane_sides.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.hpp"
#include "exact/arithmetic.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

namespace {

using exact::DoubleDoubleInterval;

constexpr std::size_t kChunk = 1 << 14;
/// Half a unit is the rounding of a coordinate; heights and planes that people compute with are
/// themselves off by one or two.
constexpr double kUnits = 4;

double unit_in_last_place(double x) {
    const double size = std::abs(x);
    return std::nextafter(size, HUGE_VAL) - size;
}

}  // namespace

PlaneDistance::PlaneDistance(const Plane& plane) : point_(plane.point), normal_(plane.normal) {
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!std::isfinite(point_[k]) || !std::isfinite(normal_[k])) {
            throw InputError("not_finite", "the plane's point and normal must be finite numbers");
        }
        largest = std::max(largest, std::abs(normal_[k]));
    }
    if (largest == 0) throw InputError("bad_plane", "the plane's normal is zero");
    int exponent = 0;
    std::frexp(largest, &exponent);
    for (double& n : normal_)
        n = std::ldexp(n, -exponent);  // the same direction, and nothing overflows
}

double PlaneDistance::rounding(const Position& p) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        sum += std::abs(normal_[k]) * unit_in_last_place(p[k]);
    return kUnits * sum;
}

DoubleDoubleInterval PlaneDistance::at(const Position& p) const {
    DoubleDoubleInterval sum;
    for (std::size_t k = 0; k < 3; ++k)
        sum = sum +
              DoubleDoubleInterval(normal_[k]) * DoubleDoubleInterval::difference(p[k], point_[k]);
    return sum;
}

// A coordinate has to be right to its own last place, however much smaller than the ends of the
// line it is: a cap is flat only if all of its corners are where the plane is, on every axis.
Position PlaneDistance::crossing(const Position& p, const Position& q) const {
    const DoubleDoubleInterval d = at(p), share = d / (d - at(q));
    std::optional<mpq_class> exact_share;
    Position result;
    for (std::size_t k = 0; k < 3; ++k) {
        if (normal_[(k + 1) % 3] == 0 && normal_[(k + 2) % 3] == 0) {
            result[k] = point_[k] + 0.0;  // of both zeros the one without a sign
            continue;
        }
        if (const auto x =
                (DoubleDoubleInterval(p[k]) + share * DoubleDoubleInterval::difference(q[k], p[k]))
                    .rounded()) {
            result[k] = *x + 0.0;
            continue;
        }
        if (!exact_share) {
            const mpq_class from = exact(p);
            exact_share = from / (from - exact(q));
        }
        const mpq_class start(p[k]);
        const mpq_class x = start + *exact_share * (mpq_class(q[k]) - start);
        result[k] = exact::nearest_double(x.get_num(), x.get_den(), 0) + 0.0;
    }
    return result;
}

std::int8_t PlaneDistance::side(const Position& p) const {
    double sum = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double term = normal_[k] * (p[k] - point_[k]);
        sum += term;
        size += std::abs(term);
    }
    if (std::abs(sum) > 0x1p-50 * size + 1e-280) return sum > 0 ? kAbove : kBelow;
    const auto sign = at(p).sign();
    const int found = sign ? *sign : sgn(exact(p));
    return found > 0 ? kAbove : found < 0 ? kBelow : kOn;
}

bool PlaneDistance::is_beside(const Position& p) const {
    const double distance = std::abs(at(p).high);
    for (std::size_t k = 0; k < 3; ++k) {
        if (distance <= std::abs(normal_[k]) * unit_in_last_place(p[k]) / 2) return true;
    }
    return false;
}

mpq_class PlaneDistance::exact(const Position& p) const {
    mpq_class sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        sum += mpq_class(normal_[k]) * (mpq_class(p[k]) - mpq_class(point_[k]));
    return sum;
}

std::vector<std::int8_t> vertex_sides(const ComplexView& model, const PlaneDistance& distance,
                                      int threads, const Progress* progress) {
    const std::size_t count = model.vertex_count();
    std::vector<std::int8_t> sides(count);
    parallel_chunks((count + kChunk - 1) / kChunk, threads, progress, [&](std::size_t c) {
        for (std::size_t v = c * kChunk; v < std::min(count, (c + 1) * kChunk); ++v)
            sides[v] = distance.side(model.vertex(static_cast<NodeId>(v)));
    });
    return sides;
}

Crossings::Crossings(const ComplexView& model, const PlaneDistance& distance,
                     std::vector<std::array<NodeId, 2>> edges)
    : first_(static_cast<NodeId>(model.vertex_count())), edges_(std::move(edges)) {
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    positions_.reserve(edges_.size());
    for (const auto& [a, b] : edges_)
        positions_.push_back(distance.crossing(model.vertex(a), model.vertex(b)));
}

NodeId Crossings::node(NodeId a, NodeId b) const {
    const std::array<NodeId, 2> edge{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    return first_ + static_cast<NodeId>(found - edges_.begin());
}

}  // namespace realmodel::cutting
