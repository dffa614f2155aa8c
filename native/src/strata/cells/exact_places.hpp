// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "exact/arithmetic.hpp"
#include "exact/formulas.hpp"
#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

/// Whole multiples of a fraction of a power of two.
inline mpq_class fraction(const mpz_class& numerator, const mpz_class& denominator, int exponent) {
    mpq_class result(numerator, denominator);
    result.canonicalize();
    if (exponent < 0) return result >> static_cast<unsigned>(-exponent);
    return result << static_cast<unsigned>(exponent);
}

/// Exact coordinates of points and heights, as reduced fractions.
class ExactPlaces {
public:
    explicit ExactPlaces(const exact::PlanArrangement& geometry)
        : geometry_(geometry), in_{geometry}, scope_(geometry) {}

    std::array<mpq_class, 2> plan(PointId id) const {
        const int unit = geometry_.plan_exponent();
        if (geometry_.is_vertex(id)) {
            const exact::Point& p = geometry_.point(id);
            return {fraction(in_.plan(p.x), 1, unit), fraction(in_.plan(p.y), 1, unit)};
        }
        const exact::VertexId origin =
            exact::anchor(geometry_, scope_.line(scope_.point(id).first));
        const exact::Point& o = geometry_.point(origin);
        const auto h = exact::position_of<mpz_class>(in_, scope_, id, origin);
        return {fraction(h.x + in_.plan(o.x) * h.w, h.w, unit),
                fraction(h.y + in_.plan(o.y) * h.w, h.w, unit)};
    }
    mpq_class height(PlaneId plane, PointId id) const {
        const exact::SpaceVertex& corner = geometry_.space(geometry_.plane(plane).corner[0]);
        const auto n = exact::plane_normal<mpz_class>(in_, geometry_, plane);
        const auto h = exact::position_of<mpz_class>(in_, scope_, id, corner.plan);
        const mpz_class w = n.c * h.w;
        return fraction(in_.height(corner.z) * w - n.a * h.x - n.b * h.y, w,
                        geometry_.height_exponent());
    }

private:
    const exact::PlanArrangement& geometry_;
    exact::IntegerArithmetic in_;
    exact::LocalArrangement scope_;
};

inline double nearest(const mpq_class& value) {
    return exact::nearest_double(value.get_num(), value.get_den(), 0);
}

}  // namespace realmodel::strata
