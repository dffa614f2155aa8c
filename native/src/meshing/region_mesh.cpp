// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/region_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "meshing/border_pieces.hpp"
#include "meshing/constrained_delaunay.hpp"
#include "meshing/lattice.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/refinement.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

namespace {

// In edge lengths. Lattice points nearer to the border than the clearance would make flat triangles
// with it; the longest edge lets pass what the band between lattice and border needs.
constexpr double clearance = 0.6;
constexpr double longest_edge = 1.6;
constexpr double shortest_edge = 1e-3;
constexpr double least_angle = 27.0 / 180 * std::numbers::pi;

// Measured at 4 million triangles (native/benchmarks/meshing_benchmark.cpp), with a reserve.
constexpr double bytes_per_triangle = 220;
constexpr double most_triangles = std::numeric_limits<std::int32_t>::max();

std::string number_text(double number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

struct Extent {
    double area = 0;   // of the region
    double reach = 0;  // largest coordinate in absolute value
    double width = 0;  // of the bounding box, the longer side
    PlanPoint low{}, high{};
};

Extent extent_of(const RingTriangulation& region) {
    Extent extent;
    extent.low = extent.high = region.graph.points.front();
    for (const PlanPoint& p : region.graph.points) {
        for (int i = 0; i < 2; ++i) {
            extent.low[i] = std::min(extent.low[i], p[i]);
            extent.high[i] = std::max(extent.high[i], p[i]);
            extent.reach = std::max(extent.reach, std::abs(p[i]));
        }
    }
    extent.width = std::max(extent.high[0] - extent.low[0], extent.high[1] - extent.low[1]);
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (!region.inside[t]) continue;
        const auto& [i, j, k] = region.triangulation.triangles[t];
        const PlanPoint &a = region.graph.points[i], &b = region.graph.points[j],
                        &c = region.graph.points[k];
        extent.area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    return extent;
}

void require_length(double edge_length) {
    if (edge_length > 0 && std::isfinite(edge_length)) return;
    throw InputError("edge_length", "the edge length is " + number_text(edge_length) +
                                        "; it must be a positive finite number");
}

MeshEstimate estimate(const RingTriangulation& region, const Extent& extent, double edge_length) {
    const double equilateral = std::numbers::sqrt3 / 4 * edge_length * edge_length;
    const double triangles = extent.area / equilateral + 2 * estimate_pieces(region, edge_length);
    return {triangles, triangles * bytes_per_triangle};
}

/// Refuses before anything large is taken; returns the number of triangles that would fit.
double require_room(const RingTriangulation& region, const Extent& extent, double edge_length) {
    const double fitting =
        std::min(most_triangles, static_cast<double>(available_memory()) / bytes_per_triangle);
    const MeshEstimate need = estimate(region, extent, edge_length);
    if (need.triangles > fitting) {
        double fits = edge_length;
        while (estimate(region, extent, fits).triangles > fitting && fits < extent.width) {
            fits *= 1.01;
        }
        throw InputError("too_large", "edge length " + number_text(edge_length) +
                                          " would need about " + number_text(need.triangles) +
                                          " triangles (" + number_text(need.bytes / 1e9) +
                                          " GB); there is room for " + number_text(fitting) +
                                          ": use an edge length of at least " + number_text(fits));
    }
    const double step = extent.reach * std::numeric_limits<double>::epsilon();
    if (edge_length * shortest_edge < 16 * step) {
        throw InputError("edge_length",
                         "edge length " + number_text(edge_length) +
                             " is too small for coordinates as large as " +
                             number_text(extent.reach) +
                             ": doubles cannot tell the points apart; use at least " +
                             number_text(17 * step / shortest_edge) +
                             ", or move the region nearer to the origin");
    }
    return fitting;
}

/// Marks the faces inside an odd number of outlines.
void mark_domain(Cdt& cdt, const Check& check) {
    enum : signed char { unknown = -1, outside = 0, inside = 1 };
    std::vector<signed char> parity;  // by time stamp
    const auto parity_of = [&](Cdt::Face_handle face) -> signed char& {
        const std::size_t stamp = face->time_stamp();
        if (stamp >= parity.size()) parity.resize(2 * stamp + 1, unknown);
        return parity[stamp];
    };
    Ticker tick(check);
    std::vector<Cdt::Face_handle> open{cdt.infinite_face()};
    parity_of(open.back()) = outside;
    while (!open.empty()) {
        tick(0.5);
        const Cdt::Face_handle face = open.back();
        open.pop_back();
        const signed char here = parity_of(face);
        face->set_in_domain(here == inside);
        for (int i = 0; i < 3; ++i) {
            const Cdt::Face_handle next = face->neighbor(i);
            signed char& there = parity_of(next);
            if (there != unknown) continue;
            there = static_cast<signed char>(face->is_constrained(i) ? 1 - here : here);
            open.push_back(next);
        }
    }
}

using Triangles = std::vector<std::array<std::int32_t, 3>>;

/// Starts each triangle with its least vertex and sorts them, by counting: linear, and it can be
/// stopped.
Triangles sorted(Triangles&& triangles, std::size_t vertices, const Check& check) {
    Ticker tick(check);
    std::vector<std::size_t> begin(vertices + 1, 0);
    for (auto& t : triangles) {
        tick(0.4);
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        ++begin[t[0] + 1];
    }
    for (std::size_t i = 1; i < begin.size(); ++i)
        begin[i] += begin[i - 1];
    Triangles out(triangles.size());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const auto& t : triangles) {
        tick(0.6);
        out[next[t[0]]++] = t;
    }
    for (std::size_t i = 0; i < vertices; ++i) {
        tick(0.7);
        std::sort(out.begin() + static_cast<std::ptrdiff_t>(begin[i]),
                  out.begin() + static_cast<std::ptrdiff_t>(begin[i + 1]));
    }
    return out;
}

/// The faces in the domain. `points` are those numbered when the triangulation was built; the last
/// `frame` of them only frame it and are left out.
PlanarMesh mesh_of(const Cdt& cdt, std::vector<PlanPoint>&& points, std::size_t frame,
                   const Check& check) {
    Ticker tick(check);
    const auto numbered = static_cast<std::int32_t>(points.size());
    const auto moved = [&](Cdt::Vertex_handle vertex) {
        return vertex->number < numbered ? vertex->number
                                         : vertex->number - static_cast<std::int32_t>(frame);
    };
    PlanarMesh mesh;
    mesh.vertices = std::move(points);
    mesh.vertices.resize(cdt.number_of_vertices() - frame);
    for (const Cdt::Vertex_handle vertex : cdt.finite_vertex_handles()) {
        tick(0);
        if (vertex->number < numbered) continue;
        mesh.vertices[moved(vertex)] = {vertex->point().x(), vertex->point().y()};
    }
    Triangles triangles;
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        tick(0.2);
        if (!face->is_in_domain()) continue;
        triangles.push_back(
            {moved(face->vertex(0)), moved(face->vertex(1)), moved(face->vertex(2))});
    }
    mesh.triangles = sorted(std::move(triangles), mesh.vertices.size(), check);
    return mesh;
}

/// Points added on edges are rounded; where outlines nearly coincide that can turn triangles over.
void require_upright(const PlanarMesh& mesh, const Check& check) {
    Ticker tick(check);
    for (const auto& [a, b, c] : mesh.triangles) {
        tick(0.9);
        if (side_of_line(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) > 0) continue;
        const PlanPoint& p = mesh.vertices[a];
        throw InputError(
            "too_close",
            "outlines come so close at " + text_of(p) +
                " that the points added on them collide; move them apart or let them touch",
            -1, {}, std::array{p[0], p[1], 0.0});
    }
}

}  // namespace

MeshEstimate estimate_region_mesh(std::span<const Ring> rings, double edge_length) {
    require_length(edge_length);
    const RingTriangulation region = triangulate_region(rings);
    return estimate(region, extent_of(region), edge_length);
}

PlanarMesh mesh_region(std::span<const Ring> rings, double edge_length, Progress* progress) {
    require_length(edge_length);
    const auto step = [&](double begin, double end, const char* text) -> Check {
        return [=](double share) {
            if (progress == nullptr) return;
            progress->report(begin + (end - begin) * share, text);
            progress->check();
        };
    };
    step(0, 0, "checking the outlines")(0);
    const RingTriangulation region = triangulate_region(rings, progress);
    const Extent extent = extent_of(region);
    const double fitting = require_room(region, extent, edge_length);

    BorderPieces border = cut_border(region, edge_length);
    std::vector<PlanPoint> points = lattice_inside(border, edge_length, clearance * edge_length,
                                                   step(0.01, 0.05, "laying out the points"));
    points.insert(points.begin(), border.points.begin(), border.points.end());
    // A frame far outside keeps the border off the hull, where cutting it could dent the hull.
    constexpr std::size_t frame = 4;
    const double far = 2 * extent.width;
    for (const double x : {extent.low[0] - far, extent.high[0] + far}) {
        for (const double y : {extent.low[1] - far, extent.high[1] + far})
            points.push_back({x, y});
    }

    Cdt cdt;
    try {
        const auto vertices = insert_points(cdt, points, step(0.05, 0.7, "triangulating"));
        insert_segments(cdt, vertices, border.pieces, step(0.7, 0.72, "triangulating"));
    } catch (const InputError& error) {
        throw InputError("too_close",
                         std::string("outlines come so close that points added on them collide: ") +
                             error.what(),
                         -1, {}, error.place);
    }
    mark_domain(cdt, step(0.72, 0.75, "finding the inside"));
    refine(cdt,
           {least_angle, longest_edge * edge_length, shortest_edge * edge_length,
            static_cast<std::size_t>(fitting / 2)},
           static_cast<std::int32_t>(points.size()), step(0.75, 0.85, "improving the border"));
    const Check finish = step(0.85, 1.0, "collecting the mesh");
    PlanarMesh mesh = mesh_of(cdt, std::move(points), frame, finish);
    require_upright(mesh, finish);
    return mesh;
}

}  // namespace realmodel::meshing
