// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "meshing/constrained_delaunay.hpp"
#include "meshing/lattice.hpp"

namespace realmodel::meshing {

namespace {

/// Edges of lattices that wait for the triangle behind them, found by their ends.
struct OpenEdge {
    VertexSegment ends;
    HalfEdge edge;
};

/// Which faces lie in the band, by time stamp: crossing its border changes it, crossing an inner
/// line does not.
std::vector<signed char> faces_in_band(const Cdt& cdt, const std::vector<VertexSegment>& inner,
                                       const Check& check) {
    constexpr signed char kUnknown = -1;
    std::size_t stamps = 0;
    for (auto face = cdt.all_faces_begin(); face != cdt.all_faces_end(); ++face)
        stamps = std::max(stamps, face->time_stamp() + 1);
    std::vector<signed char> parity(stamps, kUnknown);
    const auto is_inner = [&](Cdt::Face_handle face, int i) {
        if (inner.empty()) return false;
        return std::ranges::binary_search(
            inner, unordered(face->vertex(Cdt::ccw(i))->number, face->vertex(Cdt::cw(i))->number));
    };
    Ticker tick(check);
    std::vector<Cdt::Face_handle> open{cdt.infinite_face()};
    parity[open.back()->time_stamp()] = 0;
    while (!open.empty()) {
        tick(0.5);
        const Cdt::Face_handle face = open.back();
        open.pop_back();
        const signed char face_parity = parity[face->time_stamp()];
        for (int i = 0; i < 3; ++i) {
            const Cdt::Face_handle next = face->neighbor(i);
            signed char& neighbor_parity = parity[next->time_stamp()];
            if (neighbor_parity != kUnknown) continue;
            const bool changes = face->is_constrained(i) && !is_inner(face, i);
            neighbor_parity = static_cast<signed char>(changes ? 1 - face_parity : face_parity);
            open.push_back(next);
        }
    }
    return parity;
}

/// All lattices as one mesh, numbered on from the border's points.
void take_lattices(BandedMesh& out, std::vector<TriangleLattice>&& lattices,
                   std::vector<OpenEdge>& rim) {
    FlatMesh& mesh = out.mesh;
    for (TriangleLattice& lattice : lattices) {
        const auto points = static_cast<std::int32_t>(mesh.points.size());
        const auto triangles = static_cast<std::int32_t>(mesh.corners.size());
        mesh.points.insert(mesh.points.end(), lattice.points.begin(), lattice.points.end());
        lattice.points = {};
        for (auto& corners : lattice.mesh.corners)
            for (std::int32_t& c : corners)
                c += points;
        if (triangles == 0) {
            mesh.corners = std::move(lattice.mesh.corners);
            mesh.twins = std::move(lattice.mesh.twins);
            mesh.marks = std::move(lattice.mesh.marks);
        } else {
            for (auto& edges : lattice.mesh.twins) {
                for (HalfEdge& edge : edges)
                    if (!edge.is_none()) edge = {edge.triangle() + triangles, edge.index()};
            }
            const FlatMesh& more = lattice.mesh;
            mesh.corners.insert(mesh.corners.end(), more.corners.begin(), more.corners.end());
            mesh.twins.insert(mesh.twins.end(), more.twins.begin(), more.twins.end());
            mesh.marks.insert(mesh.marks.end(), more.marks.begin(), more.marks.end());
            lattice.mesh = {};
        }
        for (const HalfEdge edge : lattice.rim) {
            const HalfEdge moved(edge.triangle() + triangles, edge.index());
            rim.push_back({{mesh.from(moved), mesh.to(moved)}, moved});
            out.rim_triangles.push_back(moved.triangle());
        }
        for (std::int32_t& loner : lattice.loners)
            loner += points;
    }
    out.first_of_band = static_cast<std::int32_t>(mesh.corners.size());
    std::ranges::sort(rim, {}, &OpenEdge::ends);
    sort_unique(out.rim_triangles);
}

/// The points that the band is made of, and their numbers in the whole mesh.
struct BandPoints {
    std::vector<std::int32_t> numbers;  ///< in the mesh
    std::vector<std::int32_t> in_band;  ///< by number in the mesh; -1: not there
    std::vector<PlanPoint> points;

    void add(const FlatMesh& mesh, std::int32_t number) {
        if (in_band[number] >= 0) return;
        in_band[number] = static_cast<std::int32_t>(numbers.size());
        numbers.push_back(number);
        points.push_back(mesh.points[number]);
    }
};

BandPoints band_points(const FlatMesh& mesh, const BorderPieces& border,
                       std::span<const std::int32_t> loners, std::span<const OpenEdge> rim,
                       std::span<const TriangleLattice> lattices) {
    BandPoints band;
    band.in_band.assign(mesh.points.size(), -1);
    for (const auto* pieces : {&border.border, &border.inner}) {
        for (const VertexSegment& piece : *pieces) {
            band.add(mesh, piece[0]);
            band.add(mesh, piece[1]);
        }
    }
    for (const std::int32_t loner : loners)
        band.add(mesh, loner);
    for (const OpenEdge& edge : rim)
        band.add(mesh, edge.ends[0]);
    for (const TriangleLattice& lattice : lattices)
        for (const std::int32_t loner : lattice.loners)
            band.add(mesh, loner);
    return band;
}

/// Adds the band's triangles to the mesh and joins them to those of the lattices.
void add_triangles(FlatMesh& mesh, const Cdt& cdt, const std::vector<signed char>& in_band,
                   const BandPoints& band, std::span<const OpenEdge> rim) {
    std::vector<std::int32_t> triangle_of(in_band.size(), -1);
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        if (in_band[face->time_stamp()] != 1) continue;
        triangle_of[face->time_stamp()] = mesh.add_triangle(
            {band.numbers[face->vertex(0)->number], band.numbers[face->vertex(1)->number],
             band.numbers[face->vertex(2)->number]});
    }
    std::vector<HalfEdge> open;
    for (const Cdt::Face_handle face : cdt.finite_face_handles()) {
        const std::int32_t t = triangle_of[face->time_stamp()];
        if (t < 0) continue;
        for (int i = 0; i < 3; ++i) {
            const HalfEdge edge(t, i);
            const int opposite = (i + 2) % 3;  // CGAL numbers an edge by the corner opposite to it
            const Cdt::Face_handle other = face->neighbor(opposite);
            const std::int32_t beyond = triangle_of[other->time_stamp()];
            if (beyond >= 0) {
                mesh.twins[t][i] = {beyond, (other->index(face) + 1) % 3};
                if (face->is_constrained(opposite)) mesh.fix(edge);
                continue;
            }
            const VertexSegment wanted{mesh.to(edge), mesh.from(edge)};
            const auto at = std::ranges::lower_bound(rim, wanted, {}, &OpenEdge::ends);
            if (at != rim.end() && at->ends == wanted) {
                mesh.join(edge, at->edge);
                open.push_back(edge);
            } else {
                mesh.fix(edge);
            }
        }
    }
    mesh.legalize(open);
}

void lock_pieces(FlatMesh& mesh, std::int32_t first, std::span<const VertexSegment> locked) {
    if (locked.empty()) return;
    const auto lock = [&](HalfEdge edge) {
        const VertexSegment piece{mesh.from(edge), mesh.to(edge)};
        if (mesh.is_border(edge) && std::binary_search(locked.begin(), locked.end(), piece))
            mesh.fix(edge, true, true);
    };
    mesh.for_each_edge(lock, first);
}

}  // namespace

BandedMesh join_band(BorderPieces&& border, std::span<const std::int32_t> loners,
                     std::vector<TriangleLattice>&& lattices, const Check& check) {
    BandedMesh out;
    FlatMesh& mesh = out.mesh;
    mesh.points = std::move(border.points);
    std::vector<OpenEdge> rim;
    take_lattices(out, std::move(lattices), rim);
    const BandPoints band = band_points(mesh, border, loners, rim, lattices);

    std::vector<VertexSegment> segments, inner;
    for (const VertexSegment& piece : border.border)
        segments.push_back({band.in_band[piece[0]], band.in_band[piece[1]]});
    for (const OpenEdge& edge : rim)
        segments.push_back({band.in_band[edge.ends[0]], band.in_band[edge.ends[1]]});
    for (const VertexSegment& piece : border.inner) {
        inner.push_back(unordered(band.in_band[piece[0]], band.in_band[piece[1]]));
        segments.push_back(inner.back());
    }
    std::sort(inner.begin(), inner.end());

    Cdt cdt;
    const auto vertices = insert_points(cdt, band.points, check);
    insert_segments(cdt, vertices, segments, check);
    add_triangles(mesh, cdt, faces_in_band(cdt, inner, check), band, rim);
    lock_pieces(mesh, out.first_of_band, border.locked);
    return out;
}

FlatMesh mesh_without_lattice(const RegionGraph& graph, const BorderPieces& border, double finest,
                              const Check& check) {
    EdgeCutting cutting(graph.triangulation, graph.inside, border.points);
    cutting.cut(border.edges, check);
    return std::move(cutting).take_inside(finest, rounding_slack(graph.points));
}

}  // namespace realmodel::meshing
