// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/whole_faces.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>

#include "base/parallel_counts.hpp"
#include "strata/tiling/triangle_outlines.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::SpaceId;

namespace {

std::int32_t cell(const std::vector<std::int32_t>& cell_of_node, std::int32_t node) {
    return node < 0 ? kOutsideCell : cell_of_node[static_cast<std::size_t>(node)];
}

/// The faces of a complex are seen from outside the cell below, or from below where there is none.
std::array<std::int32_t, 2> turn_outwards(std::int32_t* first, std::int32_t* last,
                                          std::int32_t above, std::int32_t below) {
    if (below >= 0) return {below, above};
    std::reverse(first, last);
    return {above, below};
}

}  // namespace

void add_touched_triangles(PlanArrangement& geometry, const TriangleLinks& links,
                           WholeTriangles& wholes, FaceList& faces, const Execution& execution) {
    std::vector<std::uint8_t> is_touched(links.neighbor.size(), 0);
    parallel_each(is_touched.size(), execution, [&](std::size_t p) {
        if (!wholes.face[p].is_set() || wholes.is_added[p] != 0) return;
        const auto& neighbors = links.neighbor[p];
        is_touched[p] = wholes.is_exact[p] != 0 ||
                        std::any_of(neighbors.begin(), neighbors.end(), [&](PlaneId n) {
                            return n != kNone && wholes.is_in_parts[index(n)] != 0;
                        });
    });
    std::vector<PlaneId> planes;
    for (std::size_t p = 0; p < is_touched.size(); ++p) {
        poll(execution.progress, p);
        if (is_touched[p] == 0) continue;
        wholes.is_added[p] = 1;
        if (wholes.face[p].is_face()) planes.push_back(static_cast<PlaneId>(p));
    }
    PolygonPool outlines;
    add_outlines(
        geometry, planes.size(), [&](std::size_t i) { return geometry.plane(planes[i]).plan; },
        outlines, execution.progress);
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const WholeFace& face = wholes.of(planes[i]);
        faces.add(outlines[i], planes[i], face.surface, face.above, face.below);
    }
    for (const auto& [plane, base, node] : wholes.on_base) {
        if (is_touched[index(plane)] == 0) continue;
        faces.add(triangle_outline(geometry, geometry.plane(plane).plan), base, -1, node,
                  kOutsideCell);
    }
}

UntouchedTriangles::UntouchedTriangles(const PlanArrangement& geometry,
                                       const WholeTriangles& wholes,
                                       const std::vector<std::int32_t>& surface_of_plane,
                                       const FaceList& faces, const ConformedFaces& conformed,
                                       const Execution& execution)
    : geometry_(geometry),
      wholes_(wholes),
      surface_of_plane_(surface_of_plane),
      execution_(execution),
      of_space_(static_cast<std::size_t>(geometry.space_count()), -1),
      of_base_(wholes.on_base.empty() ? 0 : geometry.vertex_count(), -1) {
    // Several threads may say so of one vertex at once; they all write the same, but for vertices
    // of several bases, which lie on borders and so on no untouched triangle.
    const auto set = [](std::int32_t& number, std::int32_t to) {
        std::atomic_ref(number).store(to, std::memory_order_relaxed);
    };
    parallel_each(faces.size(), execution, [&](std::size_t f) {
        const bool is_base = surface_of_plane[index(faces.plane[f])] < 0;
        for (auto c = faces.polygons.offsets[f]; c < faces.polygons.offsets[f + 1]; ++c) {
            const PointId point = faces.polygons.points[c];
            if (!geometry.is_vertex(point)) continue;
            const std::int32_t number = conformed.vertices[conformed.entries.first(c)];
            if (is_base) {
                if (!of_base_.empty()) set(of_base_[index(point)], number);
                continue;
            }
            const SpaceId s = geometry.plane(faces.plane[f]).above(geometry.vertex(point));
            if (s != kNone) set(of_space_[index(s)], number);
        }
    });
}

void UntouchedTriangles::add_to(CellComplex& complex,
                                const std::vector<std::int32_t>& cell_of_node) {
    number_vertices(complex);
    add_triangles(complex, cell_of_node);
    add_bases(complex, cell_of_node);
}

/// Numbers the input vertices that only untouched triangles have, in their order.
void UntouchedTriangles::number_vertices(CellComplex& complex) {
    auto is_new = zeros<std::uint8_t>(of_space_.size(), execution_);
    parallel_each(wholes_.face.size(), execution_, [&](std::size_t p) {
        if (!is_face(p)) return;
        for (const SpaceId s : geometry_.plane(static_cast<PlaneId>(p)).corner)
            mark(is_new[index(s)]);
    });
    const std::size_t before = complex.vertices.size();
    number_in_order(
        of_space_.size(), execution_,
        [&](std::size_t s) { return is_new[s] != 0 && of_space_[s] < 0; },
        [&](std::size_t more) {
            check_total(before + more, INT32_MAX);
            complex.vertices.resize(before + more);
        },
        [&](std::size_t s, std::size_t number) {
            const auto& space = geometry_.space(static_cast<SpaceId>(s));
            const auto& at = geometry_.point(space.plan);
            complex.vertices[before + number] = {at.x, at.y, space.z};
            of_space_[s] = static_cast<std::int32_t>(before + number);
        });
}

void UntouchedTriangles::add_triangles(CellComplex& complex,
                                       const std::vector<std::int32_t>& cell_of_node) const {
    const std::size_t faces = complex.face_cells.size(), corners = complex.face_vertices.size();
    number_in_order(
        wholes_.face.size(), execution_, [&](std::size_t p) { return is_face(p); },
        [&](std::size_t count) {
            complex.face_vertices.resize(corners + 3 * count);
            complex.face_offsets.resize(faces + count + 1);
            complex.face_cells.resize(faces + count);
            complex.face_surface.resize(faces + count);
        },
        [&](std::size_t p, std::size_t number) {
            const auto& corner = geometry_.plane(static_cast<PlaneId>(p)).corner;
            std::int32_t* loop = complex.face_vertices.begin() + corners + 3 * number;
            std::transform(corner.begin(), corner.end(), loop,
                           [&](SpaceId s) { return of_space_[index(s)]; });
            complex.face_cells[faces + number] =
                turn_outwards(loop, loop + 3, cell(cell_of_node, wholes_.face[p].above),
                              cell(cell_of_node, wholes_.face[p].below));
            complex.face_surface[faces + number] = surface_of_plane_[p];
            complex.face_offsets[faces + number + 1] =
                static_cast<std::int64_t>(corners + 3 * (number + 1));
        });
}

void UntouchedTriangles::add_bases(CellComplex& complex,
                                   const std::vector<std::int32_t>& cell_of_node) {
    auto& loop = complex.face_vertices;
    for (const auto& [plane, base, node] : wholes_.on_base) {
        if (wholes_.is_added[index(plane)] != 0) continue;
        const double z = geometry_.space(geometry_.plane(base).corner[0]).z;
        for (const exact::VertexId v : geometry_.plane(plane).plan) {
            std::int32_t& number = of_base_[index(v)];
            if (number < 0) {
                number = static_cast<std::int32_t>(complex.vertices.size());
                check_total(complex.vertices.size() + 1, INT32_MAX);
                complex.vertices.push_back({geometry_.point(v).x, geometry_.point(v).y, z});
            }
            loop.push_back(number);
        }
        complex.face_cells.push_back(
            turn_outwards(loop.end() - 3, loop.end(), cell(cell_of_node, node), kOutsideCell));
        complex.face_offsets.push_back(static_cast<std::int64_t>(loop.size()));
        complex.face_surface.push_back(kBase);
    }
}

}  // namespace realmodel::strata
