// SPDX-License-Identifier: GPL-3.0-or-later
// A model cut by a plane: sides of vertices, cut edges, parts of faces, cut faces and parts of
// cells, halves.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/key_table.hpp"
#include "base/parallel.hpp"
#include "cutting/assembly.hpp"
#include "cutting/near_model.hpp"
#include "cutting/pieces.hpp"
#include "cutting/plane_division.hpp"
#include "cutting/rounding/part_rounding.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

namespace {

constexpr std::size_t kFacesAtOnce = 1 << 14;
constexpr std::size_t kCellsAtOnce = 1 << 10;
constexpr std::uint8_t kHasAbove = 1, kHasBelow = 2, kCut = kHasAbove | kHasBelow;

/// Vertices this many times farther from the plane than they are precise may be taken to lie on it
/// where otherwise a part would have no thickness in doubles.
constexpr double kNear = 16;

/// Whether a piece of a wall, seen from its side, crosses itself.
bool crosses_itself(std::span<const Position> corners) {
    PlanePosition extent{0, 0};
    for (const Position& p : corners) {
        for (std::size_t k = 0; k < 2; ++k)
            extent[k] = std::max(extent[k], std::abs(p[k] - corners[0][k]));
    }
    const std::size_t along = extent[0] >= extent[1] ? 0 : 1, n = corners.size();
    const auto at = [&](std::size_t i) {
        return PlanePosition{corners[i % n][along], corners[i % n][2]};
    };
    for (std::size_t i = 0; i < n; ++i) {
        const PlanePosition a = at(i), b = at(i + 1);
        for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j) {
            const PlanePosition p = at(j), q = at(j + 1);
            if (exact::orient2d(a, b, p) * exact::orient2d(a, b, q) < 0 &&
                exact::orient2d(p, q, a) * exact::orient2d(p, q, b) < 0)
                return true;
        }
    }
    return false;
}

class PlaneCutter {
public:
    PlaneCutter(const ComplexView& model, const Plane& plane, const Execution& execution)
        : model_(model),
          plane_(checked_plane(plane)),
          plane_point_(plane.point),
          execution_(execution) {
        sides_ = vertex_sides(model, plane_, execution);
    }

    Section section() {
        divide_faces(false);
        cut_cells(false);
        const bool clean = std::all_of(cell_cuts_.begin(), cell_cuts_.end(),
                                       [](const CellCut& cut) { return cut.is_clean; });
        if (!clean) divide();  // a cell as thin as rounding: its parts say what it has in the plane
        return assemble_section(model_, new_positions_, pieces_);
    }

    Cut cut() {
        divide();
        report(0.7, "putting the halves together");
        std::vector<HalfCell> half_cells;
        number_cells(half_cells);
        round_parts({model_, new_positions_, pieces_, half_cells, false, execution_},
                    {false, false});
        return assemble_halves(model_, new_positions_, WholePieces(std::move(pieces_)), half_cells,
                               execution_);
    }

private:
    void divide() {
        // each round but the last takes a vertex to lie on the plane, or a cell to be on the other
        // side of a face in it, once and for all
        const std::size_t bound = sides_.size() + 2 * model_.face_count();
        std::size_t rounds = 0;
        do {
            if (rounds++ > bound) throw InternalError("parts of a plane cut settle", plane_point_);
            divide_faces(true);
            report(0.4, "closing the parts");
            cut_cells(true);
        } while (settle());
    }
    void report(double share, const char* text) {
        if (execution_.progress == nullptr) return;
        execution_.progress->check();
        execution_.progress->report(share, text);
    }
    void mark_sides();
    void find_cuts();
    CutPiece origin(std::size_t face, std::int8_t side, std::span<const NodeId> polygon) const;
    void divide_faces(bool all);
    std::int8_t level_side(std::size_t face, std::size_t which, int facing) const;
    void cut_cells(bool parts);
    bool settle();
    bool straighten_walls();
    bool settle_part(std::int32_t part, const CellCut& cut, std::span<const PieceRef> refs);
    void number_cells(std::vector<HalfCell>& half_cells);
    Position position(NodeId node) const {
        return cuts_->contains(node) ? new_positions_[index(node - cuts_->first_node())]
                                     : model_.vertex(node);
    }

    const ComplexView& model_;
    exact::OrientedPlane plane_;
    Position plane_point_;
    Execution execution_;
    std::vector<std::int8_t> sides_;
    std::vector<std::uint8_t> face_sides_, cell_sides_;
    std::unique_ptr<EdgeIntersections> cuts_;
    std::vector<Position> new_positions_;  ///< of cut edges, which settle_part may move
    CutPieces pieces_;
    std::vector<std::int32_t> cut_cells_;  ///< the model's numbers, ascending
    Buckets<PieceRef> cell_pieces_;        ///< of these
    std::vector<CellCut> cell_cuts_;
    std::size_t first_cut_face_ = 0;
    std::set<std::pair<std::int32_t, std::size_t>>
        reversed_;  ///< faces in the plane, and their cell
};

/// On which sides of the plane faces and cells have corners.
void PlaneCutter::mark_sides() {
    face_sides_.assign(model_.face_count(), 0);
    parallel_ranges(
        face_sides_.size(), kFacesAtOnce, execution_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                std::uint8_t face_sides = 0;
                for (const NodeId v : model_.face(f)) {
                    const std::int8_t side = sides_[index(v)];
                    face_sides |= side == kAbove ? kHasAbove : side == kBelow ? kHasBelow : 0;
                }
                face_sides_[f] = face_sides;
            }
        });
    cell_sides_.assign(model_.cell_block.size(), 0);
    for (std::size_t f = 0; f < face_sides_.size(); ++f) {
        poll(execution_.progress, f);
        for (std::size_t k = 0; k < 2; ++k) {
            if (model_.cell(f, k) >= 0) cell_sides_[index(model_.cell(f, k))] |= face_sides_[f];
        }
    }
}

void PlaneCutter::find_cuts() {
    // each round but the last takes a vertex to lie on the plane
    for (std::size_t round = 0; round <= sides_.size(); ++round) {
        mark_sides();
        std::vector<std::array<NodeId, 2>> edges;
        for (std::size_t f = 0; f < face_sides_.size(); ++f) {
            poll(execution_.progress, f);
            if (face_sides_[f] != kCut) continue;
            const auto face = model_.face(f);
            for (std::size_t i = 0; i < face.size(); ++i) {
                const NodeId a = face[i], b = face[i + 1 < face.size() ? i + 1 : 0];
                if (sides_[index(a)] * sides_[index(b)] < 0) edges.push_back(unordered(a, b));
            }
        }
        cuts_ = std::make_unique<EdgeIntersections>(model_, plane_, std::move(edges));
        // An edge that ends just beside the plane may be cut in the very doubles where it ends.
        // Then it is contracted to its end, and with it all that is as near: what is on one
        // vertical stays together.
        bool moved = false;
        new_positions_ = cuts_->positions();
        for (std::size_t i = 0; i < cuts_->size() && !moved; ++i) {
            for (const NodeId v : cuts_->edge(cuts_->first_node() + static_cast<NodeId>(i)))
                moved = moved || model_.vertex(v) == new_positions_[i];
        }
        if (moved) {
            moved = false;
            for (std::size_t v = 0; v < sides_.size(); ++v) {
                if (sides_[v] == kOn || !plane_.is_beside(model_.vertex(static_cast<NodeId>(v))))
                    continue;
                sides_[v] = kOn;
                moved = true;
            }
        }
        if (!moved) return;
    }
    throw InternalError("cut edges of a plane settle", plane_point_);
}

/// The side of the part of a cell that a face in the plane bounds: the cell's, or where it has
/// parts on both the one that the face looks to.
std::int8_t PlaneCutter::level_side(std::size_t face, std::size_t which, int facing) const {
    const std::int32_t cell = model_.cell(face, which);
    if (cell < 0) return kOn;
    const std::uint8_t sides = cell_sides_[index(cell)];
    if (sides == kCut) {
        const bool against = reversed_.contains({static_cast<std::int32_t>(face), which});
        return ((facing > 0) == (which == 0)) != against ? kBelow : kAbove;
    }
    return sides == kHasAbove ? kAbove : kBelow;
}

/// A part of a face on one side of the plane, or in it.
CutPiece PlaneCutter::origin(std::size_t face, std::int8_t side,
                             std::span<const NodeId> polygon) const {
    const std::array cells{model_.cell(face, 0), model_.cell(face, 1)};
    CutPiece piece{
        static_cast<std::int32_t>(face), cells, {side, cells[1] < 0 ? kOn : side}, false};
    if (side != kOn) return piece;
    const auto corners = transformed(polygon, [this](NodeId node) { return position(node); });
    const double along = dot(polygon_normal(corners), plane_.normal());
    piece.is_on_cutter = true;
    for (std::size_t k = 0; k < 2; ++k)
        piece.sides[k] = level_side(face, k, along > 0 ? 1 : -1);
    return piece;
}

/// Divides the faces that the plane passes through. Where `all` is false, faces are left out that
/// no section can need.
void PlaneCutter::divide_faces(bool all) {
    report(0.1, "finding where edges are cut");
    find_cuts();
    std::vector<CutPieces> chunk_pieces((model_.face_count() + kFacesAtOnce - 1) / kFacesAtOnce);
    const auto is_cut = [&](std::int32_t cell) {
        return cell >= 0 && cell_sides_[index(cell)] == kCut;
    };
    parallel_ranges(
        model_.face_count(), kFacesAtOnce, execution_, [&](std::size_t begin, std::size_t end) {
            FaceSplitter splitter(model_, sides_, *cuts_);
            SplitFace split;
            CutPieces& pieces = chunk_pieces[begin / kFacesAtOnce];
            for (std::size_t f = begin; f < end; ++f) {
                const std::array cells{model_.cell(f, 0), model_.cell(f, 1)};
                const auto face = model_.face(f);
                if (!all && face_sides_[f] != 0 && face_sides_[f] != kCut) {
                    if (!is_cut(cells[0]) && !is_cut(cells[1])) continue;
                    const auto on = std::count_if(face.begin(), face.end(), [&](NodeId v) {
                        return sides_[index(v)] == kOn;
                    });
                    if (on < 2) continue;
                }
                split.clear();
                if (face_sides_[f] == kCut) {
                    splitter.split(face, split);
                } else if (face_sides_[f] == 0) {
                    divide_face(model_, f, split.polygons);
                    split.sides.assign(split.polygons.size(), kOn);
                } else {
                    split.polygons.add(face);
                    split.sides.push_back(face_sides_[f] == kHasAbove ? kAbove : kBelow);
                }
                for (std::size_t p = 0; p < split.sides.size(); ++p) {
                    if (split.polygons[p].size() < 3) continue;
                    pieces.add(split.polygons[p], origin(f, split.sides[p], split.polygons[p]));
                }
            }
        });
    pieces_ = {};
    for (const CutPieces& pieces : chunk_pieces)
        pieces_.add(pieces, 0, pieces.size());
    first_cut_face_ = pieces_.size();
}

void PlaneCutter::cut_cells(bool parts) {
    cut_cells_.clear();
    std::vector<std::int32_t> number(cell_sides_.size(), -1);
    for (std::size_t c = 0; c < cell_sides_.size(); ++c) {
        if (cell_sides_[c] != kCut) continue;
        number[c] = static_cast<std::int32_t>(cut_cells_.size());
        cut_cells_.push_back(static_cast<std::int32_t>(c));
    }
    const std::size_t count = cut_cells_.size();
    cell_pieces_ = bucketize<PieceRef>(count, [&](const auto& put) {
        for (std::size_t p = 0; p < first_cut_face_; ++p) {
            for (std::int32_t k = 0; k < 2; ++k) {
                const std::int32_t cell = pieces_[p].cells[index(k)];
                if (cell >= 0 && number[index(cell)] >= 0)
                    put(index(number[index(cell)]), PieceRef{static_cast<std::int32_t>(p), k});
            }
        }
    });
    cell_cuts_.assign(count, {});
    parallel_ranges(count, kCellsAtOnce, execution_, [&](std::size_t begin, std::size_t end) {
        CellCutter cutter(model_, sides_, *cuts_, pieces_, plane_);
        for (std::size_t i = begin; i < end; ++i) {
            if (parts) {
                cutter.cut(cell_pieces_[i], cell_cuts_[i]);
            } else {
                cutter.cut_face(cell_pieces_[i], cell_cuts_[i]);
            }
        }
    });
    for (std::size_t i = 0; i < count; ++i) {
        const Polygons& cut_faces = cell_cuts_[i].cut_faces;
        for (std::size_t c = 0; c < cut_faces.size(); ++c) {
            const std::int32_t cell = cut_cells_[i];
            pieces_.add(cut_faces[c], {-1, {cell, cell}, {kBelow, kAbove}, true});
        }
    }
}

/// Where a part of a cell has no thickness in doubles: gives the faces in the plane that it
/// consists of to the other side, or takes its vertices to lie on the plane, if they do but for
/// some rounding (true: to be done again), else moves a corner of its cut face by as little as
/// possible.
bool PlaneCutter::settle_part(std::int32_t part, const CellCut& cut,
                              std::span<const PieceRef> refs) {
    spatial::Box box;
    NodeId last = -1;
    std::vector<NodeId> vertices;
    bool near = true;
    for (std::size_t i = 0; i < refs.size(); ++i) {
        if (cut.part[i] != part) continue;
        for (const NodeId node : pieces_.polygons[index(refs[i].piece)]) {
            const Position p = position(node);
            box.include(p);
            if (cuts_->contains(node)) {
                last = std::max(last, node);
            } else if (sides_[index(node)] != kOn) {
                vertices.push_back(node);
                near = near && std::abs(plane_.distance(p).high) <= kNear * plane_.rounding(p);
            }
        }
    }
    if (vertices.empty()) {
        bool first_time = false;
        for (std::size_t i = 0; i < refs.size(); ++i) {
            if (cut.part[i] != part) continue;
            const auto face = pieces_[index(refs[i].piece)].face;
            first_time |= reversed_.insert({face, index(refs[i].which)}).second;
        }
        return first_time;
    }
    std::vector<std::size_t> flat;
    for (std::size_t k = 0; k < 3; ++k) {
        if (box.low[k] == box.high[k]) flat.push_back(k);
    }
    if (flat.empty()) return false;
    if (near) {
        for (const NodeId v : vertices)
            sides_[index(v)] = kOn;
        return true;
    }
    if (last >= 0) {
        Position& p = new_positions_[index(last - cuts_->first_node())];
        for (const std::size_t k : flat)
            p[k] = std::nextafter(p[k], HUGE_VAL);
    }
    return false;
}

/// Where a wall is not quite upright, by rounding, a slanted plane cuts it in a line that is not
/// straight either, and may run through vertices that it is as near to as that: then they are taken
/// to lie on it (true: to be done again).
bool PlaneCutter::straighten_walls() {
    bool moved = false;
    std::vector<NodeId> near;
    std::vector<Position> corners;
    for (std::size_t p = 0; p < first_cut_face_; ++p) {
        poll(execution_.progress, p);
        const auto face = index(pieces_[p].face);
        if (face_sides_[face] != kCut || model_.face_surface[face] != kWall) continue;
        near.clear();
        corners.clear();
        for (const NodeId node : pieces_.polygons[p]) {
            corners.push_back(position(node));
            if (cuts_->contains(node) || sides_[index(node)] == kOn) continue;
            if (std::abs(plane_.distance(corners.back()).high) <= plane_.rounding(corners.back()))
                near.push_back(node);
        }
        if (near.empty() || !crosses_itself(corners)) continue;
        for (const NodeId v : near)
            sides_[index(v)] = kOn;
        moved = true;
    }
    return moved;
}

bool PlaneCutter::settle() {
    bool moved = straighten_walls();
    for (std::size_t i = 0; i < cell_cuts_.size(); ++i) {
        poll(execution_.progress, i);
        for (std::size_t part = 0; part < cell_cuts_[i].part_side.size(); ++part)
            moved |= settle_part(static_cast<std::int32_t>(part), cell_cuts_[i], cell_pieces_[i]);
    }
    return moved;
}

void PlaneCutter::number_cells(std::vector<HalfCell>& half_cells) {
    std::vector<std::int32_t> whole(cell_sides_.size(), -1);
    std::size_t next_cut = 0;
    std::vector<std::int32_t> first_part(cell_cuts_.size());
    for (std::size_t c = 0; c < cell_sides_.size(); ++c) {
        const auto cell = static_cast<std::int32_t>(c);
        whole[c] = static_cast<std::int32_t>(half_cells.size());
        if (cell_sides_[c] != kCut) {
            half_cells.push_back({cell, cell_sides_[c] == kHasAbove ? kAbove : kBelow});
            continue;
        }
        first_part[next_cut] = whole[c];
        for (const std::int8_t side : cell_cuts_[next_cut].part_side)
            half_cells.push_back({cell, side});
        ++next_cut;
    }
    assert(next_cut == cell_cuts_.size());
    for (std::size_t p = 0; p < first_cut_face_; ++p) {
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t cell = pieces_[p].cells[k];
            pieces_[p].parts[k] = cell < 0 ? -1 : whole[index(cell)];
        }
    }
    std::size_t cut_face = first_cut_face_;
    for (std::size_t i = 0; i < cell_cuts_.size(); ++i) {
        const CellCut& cut = cell_cuts_[i];
        const auto refs = cell_pieces_[i];
        for (std::size_t r = 0; r < refs.size(); ++r)
            pieces_[index(refs[r].piece)].parts[index(refs[r].which)] = first_part[i] + cut.part[r];
        for (std::size_t c = 0; c < cut.cut_faces.size(); ++c, ++cut_face) {
            for (std::size_t k = 0; k < 2; ++k)
                pieces_[cut_face].parts[k] = first_part[i] + cut.part[refs.size() + 2 * c + k];
        }
    }
    assert(cut_face == pieces_.size());
}

}  // namespace

Cut cut_by_plane(const ComplexView& model, const Plane& plane, const Execution& execution) {
    check_model(model);
    return PlaneCutter(model, plane, execution).cut();
}

Section section_by_plane(const ComplexView& model, const Plane& plane, const Execution& execution) {
    check_model(model);
    return PlaneCutter(model, plane, execution).section();
}

// A vertical section between two points: the section of the whole plane, cut off at both ends.

namespace {

/// The part of a section above a plane. Convex polygons stay convex and in one piece (I. E.
/// Sutherland and G. W. Hodgman 1974); neighbors are cut in the same points.
Section section_above(const Section& section, const exact::OrientedPlane& plane) {
    const auto sides =
        transformed(section.vertices, [&](const Position& p) { return plane.side(p); });
    using Ends = std::array<std::int64_t, 2>;  // of the edge that a node is on, or a vertex twice
    KeyNumbers<Ends> nodes;
    std::vector<Ends> polygon;
    Section above;
    for (std::size_t k = 0; k < section.cells.size(); ++k) {
        const auto begin = static_cast<std::size_t>(section.offsets[k]);
        const auto end = static_cast<std::size_t>(section.offsets[k + 1]);
        polygon.clear();
        bool any = false;
        for (std::size_t i = begin; i < end; ++i) {
            const NodeId a = section.polygon_vertices[i];
            const NodeId b = section.polygon_vertices[i + 1 < end ? i + 1 : begin];
            any = any || sides[index(a)] == kAbove;
            if (sides[index(a)] != kBelow) polygon.push_back({a, a});
            if (sides[index(a)] * sides[index(b)] < 0)
                polygon.push_back({std::min(a, b), std::max(a, b)});
        }
        if (!any || polygon.size() < 3) continue;
        for (const Ends& ends : polygon)
            above.polygon_vertices.push_back(nodes.add(ends));
        above.offsets.push_back(static_cast<std::int64_t>(above.polygon_vertices.size()));
        above.cells.push_back(section.cells[k]);
    }
    for (const auto& [a, b] : nodes.keys()) {
        const Position &p = section.vertices[index(a)], &q = section.vertices[index(b)];
        above.vertices.push_back(a == b ? p : plane.intersection(p, q));
    }
    return above;
}

}  // namespace

Section fence_panel(const ComplexView& model, const std::array<double, 2>& start,
                    const std::array<double, 2>& end, const Execution& execution) {
    const double dx = end[0] - start[0], dy = end[1] - start[1];
    const Position first{start[0], start[1], 0}, last{end[0], end[1], 0};
    const Section whole = section_by_plane(model, {first, {dy, -dx, 0}}, execution);
    const Section begun = section_above(whole, checked_plane({first, {dx, dy, 0}}));
    return section_above(begun, checked_plane({last, {-dx, -dy, 0}}));
}

}  // namespace realmodel::cutting
