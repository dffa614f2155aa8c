// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmpxx.h>

#include <algorithm>
#include <cmath>

#include "base/floating_point.hpp"
#include "complex_defects.hpp"

namespace realmodel::fuzz {

namespace {

struct PlaneAt {
    double z, slope;
};

/// Height and slope of a triangle's plane at a plan point, by whole numbers: the normal of a needle
/// has no correct digit in doubles. Nothing where the triangle has no area in plan.
std::optional<PlaneAt> plane_at(const std::array<Point, 3>& corner, const Point& point) {
    const auto difference = [](double a, double b) -> mpq_class {
        return mpq_class(a) - mpq_class(b);
    };
    std::array<mpq_class, 3> u, v, w;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        u[axis] = difference(corner[1][axis], corner[0][axis]);
        v[axis] = difference(corner[2][axis], corner[0][axis]);
        w[axis] = difference(point[axis], corner[0][axis]);
    }
    const mpq_class area = u[0] * v[1] - u[1] * v[0];
    if (sgn(area) == 0) return std::nullopt;
    const mpq_class along_x = (v[1] * u[2] - u[1] * v[2]) / area;
    const mpq_class along_y = (u[0] * v[2] - v[0] * u[2]) / area;
    const mpq_class z = mpq_class(corner[0][2]) + along_x * w[0] + along_y * w[1];
    return PlaneAt{z.get_d(), std::hypot(along_x.get_d(), along_y.get_d())};
}

/// Whether a point lies on the plane of a triangle that is within `reach` in plan, up to rounding.
bool on_some_plane(const Mesh& surface, const Point& point, double reach) {
    for (const Triangle& t : surface.triangles) {
        std::array<Point, 3> corner;
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = surface.vertices[static_cast<std::size_t>(t[i])];
        const auto range = [&](std::size_t axis) {
            return std::minmax({corner[0][axis], corner[1][axis], corner[2][axis]});
        };
        const auto [west, east] = range(0);
        const auto [south, north] = range(1);
        const auto [lowest, highest] = range(2);
        if (point[0] < west - reach || point[0] > east + reach || point[1] < south - reach ||
            point[1] > north + reach)
            continue;
        const auto plane = plane_at(corner, point);
        if (!plane) continue;
        const double size = std::max(std::abs(lowest), std::abs(highest));
        if (std::abs(plane->z - point[2]) <=
            1e-6 * (highest - lowest) + 64 * ulp(size) + plane->slope * reach)
            return true;
    }
    return false;
}

}  // namespace

std::vector<Defect> surface_defects(const strata::CellComplex& c, const StackCase& stack) {
    std::vector<const Mesh*> surfaces;
    // Plan coordinates of any surface are joined by the rounding of the largest of all.
    double largest = 0;
    for (const RockCase& rock : stack.rocks) {
        for (const Mesh& surface : rock.surfaces) {
            surfaces.push_back(&surface);
            for (const Point& p : surface.vertices)
                largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
        }
    }
    const double reach = 64 * ulp(largest);
    std::vector<Defect> defects;
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        const std::int32_t s = c.face_surface[f];
        if (s < 0) continue;
        Point middle{};
        const auto count = static_cast<double>(c.face_offsets[f + 1] - c.face_offsets[f]);
        for (auto i = c.face_offsets[f]; i < c.face_offsets[f + 1]; ++i) {
            const auto v = static_cast<std::size_t>(c.face_vertices[static_cast<std::size_t>(i)]);
            for (std::size_t axis = 0; axis < 3; ++axis)
                middle[axis] += c.vertices[v][axis] / count;
        }
        if (on_some_plane(*surfaces[static_cast<std::size_t>(s)], middle, reach)) continue;
        defects.push_back(
            {"off its surface", "face " + std::to_string(f) + " of surface " + std::to_string(s) +
                                    " at " + std::to_string(middle[0]) + " " +
                                    std::to_string(middle[1]) + " " + std::to_string(middle[2])});
        break;
    }
    return defects;
}

}  // namespace realmodel::fuzz
