// SPDX-License-Identifier: GPL-3.0-or-later
// The polygons around parts of cells.
#include <algorithm>
#include <cassert>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "cutting/cell_parts.hpp"

namespace realmodel::cutting {

namespace {

/// Each polygon in triangles round a node of its own.
Polygons from_middle(CutterOverlay& overlay, const Polygons& polygons) {
    Polygons divided;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        const auto nodes = polygons[p];
        const NodeId center = overlay.add_node(overlay.middle_of(nodes));
        for (std::size_t i = 0; i < nodes.size(); ++i)
            divided.add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], center});
    }
    return divided;
}

}  // namespace

bool divide_loops(CutterOverlay& overlay, const Position& normal, const Loops<NodeId>& loops,
                  bool is_wall, Polygons& polygons) {
    if (is_wall && loops.size() == 1 && !arrangement::has_repeated(loops[0])) {
        polygons.add(loops[0]);
        return true;
    }
    const View view(normal);
    std::vector<Loop> corners(loops.size());
    std::vector<Position> positions;
    positions.reserve(loops[0].size());
    auto next = corners.begin();
    for (const auto loop : loops) {
        Loop& ring = *next++;
        ring.reserve(loop.size());
        for (const NodeId p : loop) {
            positions.push_back(overlay.position(p));
            ring.push_back({p, view(positions.back())});
        }
        // the same polygons wherever the loop begins
        std::rotate(ring.begin(), std::ranges::min_element(ring, {}, &LoopCorner::node),
                    ring.end());
    }
    const auto exact_of = [&](NodeId node) { return overlay.exact(node); };
    return divide_convex(corners, view.rounding(positions), {}, polygons,
                         arrangement::PointTurns(overlay.points(), view, exact_of));
}

/// Parts in the order of the model's cells, those of one cell in that of what bounds them.
void CellParts::number_parts() {
    std::vector<std::int32_t> roots;
    for (std::size_t s = 0; s < half_faces_.size(); ++s) {
        if (joined_->find(static_cast<std::int32_t>(s)) == static_cast<std::int32_t>(s))
            roots.push_back(static_cast<std::int32_t>(s));
    }
    std::stable_sort(roots.begin(), roots.end(), [this](std::int32_t a, std::int32_t b) {
        return half_faces_[index(a)].cell < half_faces_[index(b)].cell;
    });
    part_.assign(half_faces_.size(), -1);
    for (const std::int32_t root : roots) {
        part_[index(root)] = static_cast<std::int32_t>(half_cells.size());
        const HalfFace& half_face = half_faces_[index(root)];
        half_cells.push_back({half_face.cell, half_face.half, loses_[index(half_face.cell)] != 0});
    }
    for (std::size_t s = 0; s < half_faces_.size(); ++s) {
        part_[s] = part_[index(joined_->find(static_cast<std::int32_t>(s)))];
        assert(half_cells[index(part_[s])].side == half_faces_[s].half);
    }
}

/// Adds polygons between two half-faces: they turn counter-clockwise, the other
/// way where `reversed`, seen from outside of the first, and clockwise from outside of the second.
void CellParts::write(const Polygons& polygons, bool reversed, std::int32_t face,
                      std::array<std::int32_t, 2> half_faces, bool on_cutter) {
    CutPiece origin{face, {-1, -1}, {kOn, kOn}, on_cutter};
    for (std::size_t k = 0; k < 2; ++k) {
        if (half_faces[k] < 0) continue;
        const HalfFace& half_face = half_faces_[index(half_faces[k])];
        origin.cells[k] = half_face.cell;
        origin.sides[k] = half_face.half;
        origin.parts[k] = part_[index(half_faces[k])];
    }
    assert(origin.parts[0] >= 0 || origin.parts[1] >= 0);
    if (origin.parts[0] >= 0 && origin.parts[0] == origin.parts[1]) return;  // within one
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        if (reversed) {
            pieces.add_reversed(polygons[p], origin);
        } else {
            pieces.add(polygons[p], origin);
        }
    }
}

/// A face piece in polygons, which are added.
void CellParts::divide(const FacePiece& face_piece, Polygons& polygons) {
    const ComplexView& model = overlay_.model();
    const auto face = index(face_piece.face);
    if (face_piece.divided == nullptr) {
        polygons.add(model.face(face));
        return;
    }
    const auto corners = positions_of(model, model.face(face));
    const bool is_wall = model.face_surface[face] == kWall;
    Polygons whole;
    if (!divide_loops(overlay_, polygon_normal(corners), face_piece.loops(), is_wall, whole)) {
        whole.clear();
        for (const std::int32_t region : face_piece.regions()) {
            const auto [axis, facing] = overlay_.view_of(index(region));
            Position normal{0, 0, 0};
            normal[axis] = facing;
            divide_loops(overlay_, normal, overlay_.loops(index(region)), false, whole);
        }
    }
    polygons.add(whole, 0, whole.size());
}

/// Patches are divided on all threads and written in their order.
void CellParts::write_face_pieces(Progress* progress) {
    std::vector<Polygons> divided(face_pieces_.size());
    parallel_for_each(divided.size(), {overlay_.threads(), progress},
                      [&](std::size_t i) { divide(face_pieces_[i], divided[i]); });
    for (std::size_t i = 0; i < face_pieces_.size(); ++i)
        write(divided[i], false, face_pieces_[i].face, face_pieces_[i].half_faces, false);
}

/// A region of the cutter, or an undivided triangle, in polygons, which are added.
void CellParts::divide(const CutFacet& facet, Polygons& polygons) {
    if (facet.triangle >= 0) {
        auto nodes = overlay_.undivided_nodes(facet.triangle);
        std::rotate(nodes.begin(), std::ranges::min_element(nodes), nodes.end());  // as above
        polygons.add(nodes);
        return;
    }
    const std::size_t region = index(cut_faces_[facet.cut_faces].region);
    const auto corners = transformed(
        overlay_.corners(region), [this](SpacePointId p) { return overlay_.points().rounded(p); });
    divide_loops(overlay_, polygon_normal(corners), overlay_.loops(region), false, polygons);
}

/// Between what is on either side of the cutter; where on one side two cells overlap, or one is
/// inside out, the polygon is between these two.
void CellParts::write_cut_faces(Progress* progress) {
    const ComplexView& model = overlay_.model();
    std::vector<std::int32_t> outer_face(overlay_.size(), -1);
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (overlay_.of_cutter(r) || winding_.coincident(r) < 0) continue;
        for (const std::int32_t face : overlay_.faces_of(r)) {
            if (model.cell(index(face), 1) < 0) outer_face[index(winding_.coincident(r))] = face;
        }
    }
    std::vector<Polygons> in_polygons(cut_facets_.size());
    parallel_for_each(in_polygons.size(), {overlay_.threads(), progress},
                      [&](std::size_t i) { divide(cut_facets_[i], in_polygons[i]); });
    for (std::size_t i = 0; i < cut_facets_.size(); ++i) {
        const CutFaces& cut_faces = cut_faces_[cut_facets_[i].cut_faces];
        const Polygons& polygons = in_polygons[i];
        // no two polygons of a half may be the same; between two parts of a half there is one
        std::array<bool, 2> written{false, false};
        const auto add = [&](bool reversed, std::int32_t face,
                             std::array<std::int32_t, 2> half_faces, bool on_cutter) {
            const auto half_of = [this](std::int32_t half_face) -> std::size_t {
                return half_faces_[index(half_face)].half == kAbove ? 1 : 0;
            };
            bool again = false;
            for (const std::int32_t half_face : half_faces)
                again = again || (half_face >= 0 && written[half_of(half_face)]);
            for (const std::int32_t half_face : half_faces) {
                if (half_face >= 0) written[half_of(half_face)] = true;
            }
            write(again ? from_middle(overlay_, polygons) : polygons, reversed, face, half_faces,
                  on_cutter);
        };
        const std::int32_t outer = outer_face[index(cut_faces.region)];
        const auto cut_face = [&](const std::array<std::int32_t, 2>& half_faces) {
            const auto cell = [&](std::int32_t half_face) {
                return half_face < 0 ? -1 : half_faces_[index(half_face)].cell;
            };
            return sides_.cut_face_number(index(cut_faces.region), cell(half_faces[0]),
                                          cell(half_faces[1]));
        };
        for (const auto& pair : cut_faces.pairs_through) {
            const bool reversed = pair[1] < 0 && half_faces_[index(pair[0])].sign < 0;
            const bool is_outer = pair[1] < 0 && outer >= 0 &&
                                  sides_.ends_at_outer_face(index(cut_faces.region),
                                                            half_faces_[index(pair[0])].cell);
            add(reversed, is_outer ? outer : cut_face(pair), pair, true);
        }
        for (const auto& pair : cut_faces.pairs_on_one_side)
            add(false, cut_face(pair), pair, false);
    }
}

void CellParts::find_touches(Progress* progress) {
    // part and ends; of parts within one cell, two uses of an edge side by side are not too many
    std::vector<std::array<std::int32_t, 3>> edges;
    for (const auto uses : groups_of(uses_.values, &HalfFaceUse::key)) {
        if (!has_joined_cells_ && uses.size() <= 2) continue;
        for (const auto& [cell, half, use, half_face] : uses)
            edges.push_back({part_[index(half_face)], use.edge[0], use.edge[1]});
    }
    parallel_sort(edges, std::less<>(), {overlay_.threads(), progress});
    for (std::size_t i = 2; i < edges.size(); ++i) {
        if (edges[i] == edges[i - 2])
            touches[half_cells[index(edges[i][0])].side == kAbove ? 1 : 0] = true;
    }
}

}  // namespace realmodel::cutting
