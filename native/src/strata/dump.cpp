// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/dump.hpp"

#include <map>
#include <string>

#include "base/obj_file.hpp"

// Named when a program is linked (native/cmake/Fuzzing.cmake), so that it contains this file
// although it never calls it.
extern "C" {
extern const int realmodel_dump;
const int realmodel_dump = 1;
}

namespace realmodel::strata {
namespace {

using exact::PlanArrangement;
using Position = std::array<double, 3>;

std::string group_name(std::int32_t surface) {
    if (surface >= 0) return "surface_" + std::to_string(surface);
    return surface == kWall ? "walls" : surface == kBase ? "base" : "cut";
}

/// Polygons of a pool, each in its plane, in groups by surface.
template <class Pool>
void dump_polygons(const PlanArrangement& geometry, const Pool& polygons,
                   const Array<PlaneId>& plane, const Array<std::int32_t>& surface,
                   const char* path) {
    std::map<std::int32_t, std::vector<std::size_t>> of_surface;
    for (std::size_t p = 0; p < plane.size(); ++p) {
        if (plane[p].has_value()) of_surface[surface[p]].push_back(p);
    }
    LocalArrangement local(geometry);
    ObjFile file(path);
    std::vector<Position> corners;
    for (const auto& [number, members] : of_surface) {
        file.begin_group(number < 0 ? group_name(kBase) : group_name(number));
        for (const std::size_t p : members) {
            corners.clear();
            const auto& polygon = polygons[p];
            for (const Corner& corner : polygon) {
                const auto [x, y] = local.rounded(corner.point);
                corners.push_back({x, y, local.rounded_height(plane[p], corner.point)});
            }
            file.add('f', corners);
        }
    }
}

/// Where a line enters and leaves the box of the input; the same position twice where it does not
/// cross it.
std::array<Position, 2> across_box(const PlanArrangement& geometry, LineId line) {
    const exact::LineFilter f = geometry.filter(line);
    const exact::PlanReach& box = geometry.reach();
    const double length = std::abs(f.a) + std::abs(f.b);
    if (length == 0) return {};
    // a position on the line, and the box's size along it in both directions
    const double square = f.a * f.a + f.b * f.b;
    const double x = f.x0 - f.a * f.c / square, y = f.y0 - f.b * f.c / square;
    const double ux = -f.b / std::sqrt(square), uy = f.a / std::sqrt(square);
    double from = -HUGE_VAL, to = HUGE_VAL;
    const auto keep_between = [&](double start, double step, double low, double high) {
        if (step == 0) return;
        const double first = (low - start) / step, last = (high - start) / step;
        from = std::max(from, std::min(first, last));
        to = std::min(to, std::max(first, last));
    };
    keep_between(x, ux, box.low_x, box.high_x);
    keep_between(y, uy, box.low_y, box.high_y);
    to = std::max(from, to);
    return {Position{x + from * ux, y + from * uy, 0}, Position{x + to * ux, y + to * uy, 0}};
}

}  // namespace

void dump_envelope(const PlanArrangement& geometry, const Envelope& envelope, const char* path) {
    dump_polygons(geometry, envelope.outlines, envelope.plane, envelope.surface, path);
}

void dump_faces(const PlanArrangement& geometry, const FaceList& faces, const char* path) {
    dump_polygons(geometry, faces.polygons, faces.plane, faces.surface, path);
}

void dump_arrangement(const PlanArrangement& geometry, const char* path) {
    ObjFile file(path);
    for (std::size_t p = 0; p < geometry.point_count(); ++p) {
        const exact::Point& point = geometry.point(static_cast<PointId>(p));
        file.add_vertex({point.x, point.y, 0});
    }
    for (const bool edges : {true, false}) {
        file.begin_group(edges ? "edges" : "traces");
        for (std::size_t l = 0; l < geometry.line_count(); ++l) {
            const auto line = static_cast<LineId>(l);
            if (geometry.line(line).is_edge() == edges) file.add('l', across_box(geometry, line));
        }
    }
}

void dump_complex(const CellComplex& cells, const char* path) {
    std::map<std::int32_t, std::vector<std::size_t>> of_surface;
    for (std::size_t f = 0; f < cells.face_surface.size(); ++f)
        of_surface[cells.face_surface[f]].push_back(f);
    ObjFile file(path);
    for (const Position& vertex : cells.vertices)
        file.add_vertex(vertex);
    for (const auto& [surface, faces] : of_surface) {
        file.begin_group(group_name(surface));
        for (const std::size_t f : faces) {
            const auto first = static_cast<std::size_t>(cells.face_offsets[f]);
            const auto end = static_cast<std::size_t>(cells.face_offsets[f + 1]);
            file.add_face({cells.face_vertices.data() + first, end - first});
        }
    }
}

}  // namespace realmodel::strata
