// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/constrained_delaunay.hpp"

#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "meshing/plan_predicates.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

constexpr std::size_t kPointsBetweenChecks = 1024;

/// Gives CGAL's sort the point of a number, and the caller a chance to stop it.
struct PointOfNumber {
    using key_type = std::int32_t;
    using value_type = Kernel::Point_2;
    using reference = Kernel::Point_2;
    using category = boost::readable_property_map_tag;

    const PlanPoint* points;
    const Check* check;
    std::size_t* calls;

    friend Kernel::Point_2 get(const PointOfNumber& map, std::int32_t number) {
        if (++*map.calls % (64 * kPointsBetweenChecks) == 0) (*map.check)(0);
        const PlanPoint& p = map.points[number];
        return {p[0], p[1]};
    }
};

std::vector<std::int32_t> curve_order(std::span<const PlanPoint> points, const Check& check) {
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::size_t calls = 0;
    const PointOfNumber map{points.data(), &check, &calls};
    CGAL::spatial_sort(order.begin(), order.end(),
                       CGAL::Spatial_sort_traits_adapter_2<Kernel, PointOfNumber>(map));
    return order;
}

PlanPoint point_of(const Cdt::Vertex_handle& vertex) {
    return {vertex->point().x(), vertex->point().y()};
}

/// Names the segment that the refused one crosses: the first before it that does.
[[noreturn]] void refuse_crossing(std::span<const Cdt::Vertex_handle> vertices,
                                  std::span<const VertexSegment> segments, std::size_t refused) {
    const PlanPoint a = point_of(vertices[segments[refused][0]]);
    const PlanPoint b = point_of(vertices[segments[refused][1]]);
    for (std::size_t other = 0; other < refused; ++other) {
        const PlanPoint c = point_of(vertices[segments[other][0]]);
        const PlanPoint d = point_of(vertices[segments[other][1]]);
        if (!cross_properly(a, b, c, d)) continue;
        const PlanPoint place = crossing_place(a, b, c, d);
        throw InputError("crossing",
                         "segments " + std::to_string(other) + " and " + std::to_string(refused) +
                             " cross at " + text_of(place),
                         -1, {static_cast<std::int64_t>(other), static_cast<std::int64_t>(refused)},
                         std::array{place[0], place[1], 0.0});
    }
    throw InternalError("a segment that is refused crosses one before it",
                        std::array{a[0], a[1], 0.0});
}

}  // namespace

std::vector<Cdt::Vertex_handle> insert_points(Cdt& cdt, std::span<const PlanPoint> points,
                                              const Check& check, Repeated repeated) {
    if (static_cast<double>(points.size()) > std::numeric_limits<std::int32_t>::max()) {
        throw InputError("too_large", "there are more points than 32-bit numbers can count");
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::isfinite(points[i][0]) && std::isfinite(points[i][1])) continue;
        throw InputError("not_finite", "point " + std::to_string(i) + " is not a finite number", -1,
                         {static_cast<std::int64_t>(i)});
    }
    std::vector<Cdt::Vertex_handle> vertices(points.size());
    Cdt::Face_handle near;
    std::size_t done = 0;
    for (const std::int32_t number : curve_order(points, check)) {
        if (++done % kPointsBetweenChecks == 0) {
            check(static_cast<double>(done) / static_cast<double>(points.size()));
        }
        const PlanPoint& p = points[number];
        const Cdt::Vertex_handle vertex = cdt.insert({p[0], p[1]}, near);
        near = vertex->face();
        vertices[number] = vertex;
        if (vertex->number >= 0 && repeated == Repeated::kJoin) {
            vertex->number = std::min(vertex->number, number);
            continue;
        }
        if (vertex->number >= 0) {
            const auto [first, second] = std::minmax(vertex->number, number);
            throw InputError("repeated_point",
                             "points " + std::to_string(first) + " and " + std::to_string(second) +
                                 " are equal: " + text_of(p),
                             -1, {first, second}, std::array{p[0], p[1], 0.0});
        }
        vertex->number = number;
    }
    return vertices;
}

void insert_segments(Cdt& cdt, std::span<const Cdt::Vertex_handle> vertices,
                     std::span<const VertexSegment> segments, const Check& check,
                     std::vector<std::size_t>* refused) {
    const auto known = [&](std::int32_t point) {
        return point >= 0 && static_cast<std::size_t>(point) < vertices.size();
    };
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (i % kPointsBetweenChecks == 0) {
            check(static_cast<double>(i) / static_cast<double>(segments.size()));
        }
        const auto [from, to] = segments[i];
        if (!known(from) || !known(to) || from == to) {
            throw InputError("bad_index",
                             "segment " + std::to_string(i) + " does not join two of the points",
                             -1, {static_cast<std::int64_t>(i)});
        }
        try {
            cdt.insert_constraint(vertices[from], vertices[to]);
        } catch (const Cdt::Intersection_of_constraints_exception&) {
            if (refused == nullptr) refuse_crossing(vertices, segments, i);
            refused->push_back(i);
        }
    }
}

std::vector<CoveredEdge> covered_edges(const Cdt& cdt, std::span<const Cdt::Vertex_handle> vertices,
                                       std::span<const VertexSegment> segments) {
    std::vector<CoveredEdge> edges;
    edges.reserve(segments.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Cdt::Vertex_handle end = vertices[segments[i][1]];
        Cdt::Vertex_handle at = vertices[segments[i][0]];
        while (at != end) {
            Cdt::Vertex_handle next;
            Cdt::Face_handle face;
            int opposite_corner = 0;
            if (!cdt.includes_edge(at, end, next, face, opposite_corner)) {
                const PlanPoint p = point_of(at);
                throw InternalError("an inserted segment is a chain of edges",
                                    std::array{p[0], p[1], 0.0});
            }
            const auto [from, to] = std::minmax(at->number, next->number);
            edges.push_back({from, to, static_cast<std::int32_t>(i)});
            at = next;
        }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

ConstrainedTriangulation numbered_triangles(const Cdt& cdt) {
    ConstrainedTriangulation out;
    if (cdt.dimension() < 2) return out;

    struct NumberedFace {
        std::array<std::int32_t, 3> corners;
        int first;
        Cdt::Face_handle handle;
    };
    std::vector<NumberedFace> faces;
    faces.reserve(cdt.number_of_faces());
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        int first = 0;
        for (int i = 1; i < 3; ++i) {
            if (face->vertex(i)->number < face->vertex(first)->number) first = i;
        }
        faces.push_back({{face->vertex(first)->number, face->vertex(Cdt::ccw(first))->number,
                          face->vertex(Cdt::cw(first))->number},
                         first,
                         face});
    }
    std::ranges::sort(faces, {}, &NumberedFace::corners);

    // The time stamp leads from a face back to its number without a hash table.
    std::size_t stamps = 0;
    for (const NumberedFace& face : faces)
        stamps = std::max(stamps, face.handle->time_stamp() + 1);
    std::vector<std::int32_t> number_of(stamps, -1);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        number_of[faces[i].handle->time_stamp()] = static_cast<std::int32_t>(i);
    }
    out.triangles.reserve(faces.size());
    out.neighbors.reserve(faces.size());
    out.constrained.reserve(faces.size());
    for (const NumberedFace& face : faces) {
        out.triangles.push_back(face.corners);
        auto& neighbors = out.neighbors.emplace_back();
        auto& constrained = out.constrained.emplace_back();
        for (int i = 0; i < 3; ++i) {
            // CGAL numbers an edge by the corner opposite to it.
            const int opposite = (face.first + i + 2) % 3;
            const Cdt::Face_handle across = face.handle->neighbor(opposite);
            neighbors[i] = cdt.is_infinite(across) ? -1 : number_of[across->time_stamp()];
            constrained[i] = face.handle->is_constrained(opposite);
        }
    }
    return out;
}

ConstrainedTriangulation constrained_delaunay(std::span<const PlanPoint> points,
                                              std::span<const VertexSegment> segments,
                                              const Progress* progress) {
    const Check check = stopped_by(progress);
    Cdt cdt;
    const std::vector<Cdt::Vertex_handle> vertices = insert_points(cdt, points, check);
    insert_segments(cdt, vertices, segments, check);
    ConstrainedTriangulation out = numbered_triangles(cdt);
    out.covered = covered_edges(cdt, vertices, segments);
    return out;
}

}  // namespace realmodel::meshing
