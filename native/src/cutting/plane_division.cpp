// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/plane_division.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "arrangement/polygons.hpp"
#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "cutting/shell.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

exact::OrientedPlane checked_plane(const Plane& plane) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (!std::isfinite(plane.point[k]) || !std::isfinite(plane.normal[k]))
            throw InputError("not_finite", "the plane's point and normal must be finite numbers");
    }
    if (plane.normal == Position{0, 0, 0})
        throw InputError("bad_plane", "the plane's normal is zero");
    return {plane.point, plane.normal};
}

std::vector<std::int8_t> vertex_sides(const ComplexView& model, const exact::OrientedPlane& plane,
                                      const Execution& execution) {
    std::vector<std::int8_t> sides(model.vertex_count());
    parallel_ranges(sides.size(), 1 << 14, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            sides[v] = plane.side(model.vertex(static_cast<NodeId>(v)));
    });
    return sides;
}

EdgeIntersections::EdgeIntersections(const ComplexView& model, const exact::OrientedPlane& plane,
                                     std::vector<std::array<NodeId, 2>> edges)
    : first_(static_cast<NodeId>(model.vertex_count())), edges_(std::move(edges)) {
    sort_unique(edges_);
    checked_number(model.vertex_count() + edges_.size(), "vertices and cut edges");
    positions_.reserve(edges_.size());
    for (const auto& [a, b] : edges_)
        positions_.push_back(plane.intersection(model.vertex(a), model.vertex(b)));
}

NodeId EdgeIntersections::node(NodeId a, NodeId b) const {
    const std::array<NodeId, 2> edge = unordered(a, b);
    const auto cut_edge = std::lower_bound(edges_.begin(), edges_.end(), edge);
    if (cut_edge == edges_.end() || *cut_edge != edge)
        throw InternalError("an edge from one side of the plane to the other is cut");
    return first_ + static_cast<NodeId>(cut_edge - edges_.begin());
}

exact::RationalPoint PlanePoints::exact_point(NodeId node) const {
    if (cuts_.contains(node)) {
        const auto& [a, b] = cuts_.edge(node);
        return plane_.exact_intersection(model_.vertex(a), model_.vertex(b));
    }
    const Position p = model_.vertex(node);
    return {mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])};
}

/// How far differences of a node's coordinates may be from the true ones, as that of
/// exact::SpacePoints: cut edges' positions are the nearest doubles.
double PlanePoints::inexactness(NodeId node) const {
    if (!cuts_.contains(node)) return 0;
    double largest = 0;
    for (const double x : cuts_.position(node))
        largest = std::max(largest, std::abs(x));
    return exact::inexactness_of_rounding(largest);
}

int PlanePoints::operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const {
    if (a.node == b.node || b.node == c.node || a.node == c.node) return 0;
    const double off = std::max({inexactness(a.node), inexactness(b.node), inexactness(c.node)});
    if (const auto sign = exact::orient2d_filter(a.at, b.at, c.at, off)) return *sign;
    const exact::RationalPoint o = exact_point(a.node);
    return view_.sign() * sgn(exact::cross(exact::minus(exact_point(b.node), o),
                                           exact::minus(exact_point(c.node), o), view_.axis()));
}

int PlanePoints::tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const {
    const double off = std::max({inexactness(a), inexactness(b), inexactness(c), inexactness(d)});
    if (const auto sign =
            exact::orient3d_filter(rounded(a), rounded(b), rounded(c), rounded(d), off))
        return *sign;
    const exact::RationalPoint o = exact_point(a);
    const auto from_a = [&](NodeId node) { return exact::minus(exact_point(node), o); };
    return sgn(exact::dot(from_a(b), exact::cross(from_a(c), from_a(d))));
}

/// A part of a triangle on one side of the plane. Its edges are those of the triangle, or the cut.
struct FaceSplitter::TrianglePiece {
    std::vector<NodeId> nodes;
    std::int8_t side = kOn;
};

/// Nodes where the plane cuts the edges of a face's triangles. Those of diagonals are negative
/// numbers, for no one else knows them.
class FaceSplitter::Cuts {
public:
    Cuts(std::span<const std::array<LoopCorner, 3>> triangles, const EdgeIntersections& of_edges)
        : of_edges_(of_edges) {
        for (const auto& t : triangles) {
            for (std::size_t i = 0; i < 3; ++i)
                edges_.push_back(unordered(t[i].node, t[(i + 1) % 3].node));
        }
        std::sort(edges_.begin(), edges_.end());
    }
    NodeId node(NodeId a, NodeId b) const {
        const auto [begin, end] = std::equal_range(edges_.begin(), edges_.end(), unordered(a, b));
        const bool is_diagonal = end - begin > 1;
        return is_diagonal ? static_cast<NodeId>(-1 - (begin - edges_.begin()))
                           : of_edges_.node(a, b);
    }

private:
    const EdgeIntersections& of_edges_;
    std::vector<std::array<NodeId, 2>> edges_;  ///< of all triangles: diagonals are there twice
};

void FaceSplitter::split(std::span<const NodeId> face, SplitFace& split) {
    if (!split_in_two(face, split)) split_by_triangles(face, split);
}

bool FaceSplitter::split_in_two(std::span<const NodeId> face, SplitFace& split) {
    cycle_.clear();
    std::array<std::size_t, 2> on{};
    std::size_t on_count = 0;
    for (std::size_t i = 0; i < face.size(); ++i) {
        const NodeId a = face[i], b = face[i + 1 < face.size() ? i + 1 : 0];
        if (side(a) == kOn) {
            if (on_count == 2) return false;
            on[on_count++] = cycle_.size();
        }
        cycle_.push_back(a);
        if (side(a) * side(b) < 0) {
            if (on_count == 2) return false;
            on[on_count++] = cycle_.size();
            cycle_.push_back(cuts_.node(a, b));
        }
    }
    if (on_count != 2 || on[1] - on[0] < 2 || on[0] + cycle_.size() - on[1] < 2) return false;
    const auto side_after = [&](std::size_t i) { return side(cycle_[(i + 1) % cycle_.size()]); };
    for (const auto& [from, to] : {std::pair(on[0], on[1]), std::pair(on[1], on[0])}) {
        split.sides.push_back(side_after(from));
        for (std::size_t i = from;; i = (i + 1) % cycle_.size()) {
            split.polygons.nodes.push_back(cycle_[i]);
            if (i == to) break;
        }
        split.polygons.close();
    }
    return true;
}

/// The parts of a triangle above the plane and below it; the whole of it where it lies in the
/// plane.
void FaceSplitter::split_triangle(const std::array<LoopCorner, 3>& t, const Cuts& cuts,
                                  std::vector<TrianglePiece>& pieces) const {
    TrianglePiece above{{}, kAbove}, below{{}, kBelow}, whole{{}, kOn};
    bool has_above = false, has_below = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const NodeId a = t[i].node, b = t[(i + 1) % 3].node;
        whole.nodes.push_back(a);
        if (side(a) >= 0) above.nodes.push_back(a);
        if (side(a) <= 0) below.nodes.push_back(a);
        has_above = has_above || side(a) > 0;
        has_below = has_below || side(a) < 0;
        if (side(a) * side(b) < 0) {
            const NodeId c = cuts.node(a, b);
            above.nodes.push_back(c);
            below.nodes.push_back(c);
        }
    }
    if (has_above) pieces.push_back(std::move(above));
    if (has_below) pieces.push_back(std::move(below));
    if (!has_above && !has_below) pieces.push_back(std::move(whole));
}

void FaceSplitter::split_by_triangles(std::span<const NodeId> face, SplitFace& split) {
    const auto [loop, rounding] = loop_of(model_, face);
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(std::span(&loop, 1), rounding, triangles);
    const Cuts cuts(triangles, cuts_);
    std::vector<TrianglePiece> pieces;
    for (const auto& t : triangles)
        split_triangle(t, cuts, pieces);

    // Parts are joined wherever they do not lie on different sides; those in the plane take the
    // side of a neighbor.
    arrangement::JoinedPolygons joined;
    for (std::size_t p = 0; p < pieces.size(); ++p)
        joined.add(pieces[p].nodes, static_cast<std::int32_t>(p));
    const auto side_of = [&pieces](std::int32_t p) -> std::int8_t& {
        return pieces[index(p)].side;
    };
    joined.pair(
        [&](const auto&, std::int32_t p, std::int32_t q) { return side_of(p) * side_of(q) >= 0; });
    for (bool changed = true; changed;) {
        changed = false;
        joined.for_each_pair([&](std::int32_t p, std::int32_t q) {
            if (side_of(p) != kOn || side_of(q) == kOn) return;
            side_of(p) = side_of(q);
            changed = true;
        });
    }
    joined.separate([&](std::int32_t p, std::int32_t q) { return side_of(p) == side_of(q); });
    joined.for_each_outline(
        [&](std::span<const arrangement::JoinedPolygons::PolygonHalfEdge> outline) {
            for (const auto& edge : outline) {
                if (edge.from >= 0) split.polygons.nodes.push_back(edge.from);
            }
            split.polygons.close();
            split.sides.push_back(side_of(outline[0].polygon));
        });
}

void CellCutter::cut_face(std::span<const PieceRef> refs, CellCut& result) {
    collect_uses(refs, true);
    close(refs, result);
}

void CellCutter::close(std::span<const PieceRef> refs, CellCut& result) {
    collect_open_edges(refs);
    trace_loops();
    result.cut_faces.clear();
    result.is_clean = true;
    if (whole_loops_) {
        take_whole_loops(result.cut_faces);
    } else if (!loops_.empty()) {
        result.is_clean = divide_convex(loops_, rounding_, slits_, result.cut_faces, points_);
    }
}

/// Each loop as one polygon, several where it passes a node twice.
void CellCutter::take_whole_loops(Polygons& cut_faces) const {
    std::vector<NodeId> path;
    for (const Loop& loop : loops_) {
        path.clear();
        for (const LoopCorner& corner : loop) {
            const auto met = std::find(path.begin(), path.end(), corner.node);
            if (path.end() - met >= 3) cut_faces.add({met, path.end()});
            path.erase(met, path.end());
            path.push_back(corner.node);
        }
        if (path.size() >= 3) cut_faces.add(path);
    }
}

void CellCutter::cut(std::span<const PieceRef> refs, CellCut& result) {
    // each round but the last dissolves a slit, or leaves loops undivided, once and for all
    std::size_t rounds = 0;
    do {
        collect_uses(refs, false);
        if (rounds++ > uses_.size() + 1) throw InternalError("caps of a plane cut close its parts");
        close(refs, result);
    } while (!find_parts(refs, result));
    dissolved_.clear();
    whole_loops_ = false;
}

void CellCutter::collect_uses(std::span<const PieceRef> refs, bool in_plane_only) {
    uses_.clear();
    piece_side_.clear();
    for (std::size_t i = 0; i < refs.size(); ++i) {
        piece_side_.push_back(pieces_[index(refs[i].piece)].sides[index(refs[i].which)]);
        for_each_edge(std::array{pieces_.polygons[index(refs[i].piece)]},
                      static_cast<std::int32_t>(i), [&](EdgeUse use) {
                          if (in_plane_only && !in_plane(use.edge)) return;
                          if (refs[i].which == 1)
                              use.direction = static_cast<std::int8_t>(-use.direction);
                          uses_.push_back(use);
                      });
    }
    std::sort(uses_.begin(), uses_.end());
}

/// A node of a piece that is not in the plane.
NodeId CellCutter::far_node(const EdgeUse& use, std::span<const PieceRef> refs) const {
    for (const NodeId node : pieces_.polygons[index(refs[index(use.item)].piece)]) {
        if (!in_plane(node)) return node;
    }
    return use.edge[0];
}

/// Of an edge in the plane whose faces all rise from it, or all fall: whether the cell lies on both
/// sides of it. It does where the lowest of the rising faces, going round from the right side of
/// the edge, is one that the cell ends at.
bool CellCutter::has_cut_faces_on_both_sides(std::span<const EdgeUse> uses,
                                             std::span<const PieceRef> refs) const {
    for (const std::int8_t side : {kAbove, kBelow}) {
        const EdgeUse* flattest = nullptr;
        for (const EdgeUse& use : uses) {
            if (side_of(use.item) != side) continue;
            if (flattest == nullptr) {
                flattest = &use;
                continue;
            }
            // seen along the edge, angles are counted from the right over the top to the left
            const int orientation = points_.tetrahedron(
                use.edge[0], use.edge[1], far_node(*flattest, refs), far_node(use, refs));
            if (orientation * side > 0) flattest = &use;
        }
        if (flattest == nullptr) continue;
        return flattest->direction == (side == kAbove ? -1 : 1);
    }
    return false;
}

void CellCutter::collect_open_edges(std::span<const PieceRef> refs) {
    open_.clear();
    slits_.clear();
    for (const auto of_edge : groups_of(uses_, &EdgeUse::key)) {
        const auto edge = of_edge[0].edge;
        if (!in_plane(edge)) continue;
        int net = 0, above = 0, below = 0;
        bool on_cutter = false;
        for (const EdgeUse& use : of_edge) {
            const bool is_above = side_of(use.item) == kAbove;
            if (is_above) net += use.direction;
            (is_above ? above : below) += 1;
            on_cutter = on_cutter || pieces_[index(refs[index(use.item)].piece)].is_on_cutter;
        }
        for (int i = 0; i < std::abs(net); ++i)
            open_.push_back(net > 0 ? CutFaceEdge{edge[0], edge[1]}
                                    : CutFaceEdge{edge[1], edge[0]});
        const bool may_pass = net == 0 && !on_cutter && (above > 1 || below > 1);
        if (may_pass && !std::binary_search(dissolved_.begin(), dissolved_.end(), edge) &&
            has_cut_faces_on_both_sides(of_edge, refs))
            slits_.push_back(edge);
    }
    keep_slits_in_cut_faces();
}

/// Whether the open edges go round the middle of an edge in the plane.
bool CellCutter::is_in_cut_faces(const std::array<NodeId, 2>& edge) const {
    const PlanePosition a = corner(edge[0]).at, b = corner(edge[1]).at;
    const PlanePosition middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    int times = 0;
    for (const CutFaceEdge& e : open_) {
        const PlanePosition p = corner(e.from).at, q = corner(e.to).at;
        if ((p[1] > middle[1]) == (q[1] > middle[1])) continue;
        if (q[1] > p[1] ? twice_area(p, q, middle) > 0 : twice_area(p, q, middle) < 0)
            times += q[1] > p[1] ? 1 : -1;
    }
    return times != 0;
}

/// A part of the cell's boundary may touch the plane where the cell has a face in it. There nothing
/// is open on either side, however steep the faces are that meet in the edge.
void CellCutter::keep_slits_in_cut_faces() {
    std::erase_if(slits_, [this](const auto& edge) { return !is_in_cut_faces(edge); });
    for (const auto& edge : slits_) {
        open_.push_back({edge[0], edge[1]});
        open_.push_back({edge[1], edge[0]});
    }
}

/// Of the edges that leave the node where one arrives, the first clockwise from the edge that
/// arrives: the one that bounds the same piece of the region, which lies to the left.
std::size_t CellCutter::next_edge(const CutFaceEdge& arriving,
                                  const std::vector<bool>& taken) const {
    const auto begin = static_cast<std::size_t>(
        std::lower_bound(open_.begin(), open_.end(), arriving.to,
                         [](const CutFaceEdge& e, NodeId node) { return e.from < node; }) -
        open_.begin());
    std::size_t best = open_.size();
    LoopCorner at{}, back{};
    const auto half = [&](const LoopCorner& p) {
        const int orientation = points_(at, back, p);
        if (orientation != 0) return orientation < 0 ? 0 : 2;
        const double along = (p.at[0] - at.at[0]) * (back.at[0] - at.at[0]) +
                             (p.at[1] - at.at[1]) * (back.at[1] - at.at[1]);
        return along < 0 ? 1 : 3;
    };
    for (std::size_t e = begin; e < open_.size() && open_[e].from == arriving.to; ++e) {
        if (taken[e]) continue;
        if (best == open_.size()) {
            best = e;
            continue;
        }
        at = corner(arriving.to);
        back = corner(arriving.from);
        const LoopCorner p = corner(open_[best].to), q = corner(open_[e].to);
        const int first = half(p), second = half(q);
        if (second < first || (second == first && points_(at, q, p) < 0)) best = e;
    }
    return best;
}

void CellCutter::trace_loops() {
    loops_.clear();
    std::sort(open_.begin(), open_.end(), [](const CutFaceEdge& a, const CutFaceEdge& b) {
        return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    std::vector<bool> taken(open_.size(), false);
    std::vector<Position> positions;
    for (std::size_t start = 0; start < open_.size(); ++start) {
        if (taken[start]) continue;
        Loop& loop = loops_.emplace_back();
        // As many edges arrive at each node as leave it: a walk ends where it began, once the
        // region goes on with the first edge.
        std::size_t e = start;
        do {
            assert(e < open_.size() && (e == start || !taken[e]));
            taken[e] = e != start;
            positions.push_back(points_.rounded(open_[e].from));
            loop.push_back(corner(open_[e].from));
            e = next_edge(open_[e], taken);
        } while (e != start);
        taken[start] = true;
    }
    rounding_ = points_.view().rounding(positions);
}

// The parts that a cell falls into.

/// The side of an item: a piece, or what is below or above a cut face.
std::int8_t CellCutter::side_of(std::int32_t item) const {
    const std::size_t i = index(item);
    if (i < piece_side_.size()) return piece_side_[i];
    return (i - piece_side_.size()) % 2 == 0 ? kBelow : kAbove;
}

/// The edges of the cut faces, as seen from below, beside the others.
void CellCutter::add_uses_of_cut_faces(const Polygons& cut_faces, std::int32_t pieces) {
    const auto first_cut_face_item = static_cast<std::ptrdiff_t>(uses_.size());
    for (std::int32_t c = 0; index(c) < cut_faces.size(); ++c)
        for_each_edge(std::array{cut_faces[index(c)]}, pieces + 2 * c,
                      [this](const EdgeUse& use) { uses_.push_back(use); });
    std::sort(uses_.begin() + first_cut_face_item, uses_.end());
    std::inplace_merge(uses_.begin(), uses_.begin() + first_cut_face_item, uses_.end());
}

/// Joins what meets at an edge on one side of the plane: each cut face with a face, and what finds
/// no partner. As often as the edge is used one way it is used the other: so it is within each
/// pair, and among all that stay together.
void CellCutter::join_at_edge(std::span<const EdgeUse> uses, std::int8_t side, DisjointSets& sets) {
    const auto pieces = static_cast<std::int32_t>(piece_side_.size());
    const std::int32_t cut_face_side = side == kBelow ? 0 : 1;
    auto& faces = faces_at_edge_;
    faces.clear();
    for (const EdgeUse& use : uses) {
        if (use.item < pieces && side_of(use.item) == side) faces.push_back(&use);
    }
    std::int32_t unpaired = -1;
    const auto join_unpaired = [&](std::int32_t local) {
        if (unpaired >= 0) sets.join(unpaired, local);
        unpaired = local;
    };
    for (const EdgeUse& cut_face : uses) {
        if (cut_face.item < pieces) continue;
        const auto met = std::ranges::find_if(faces, [&](const EdgeUse* face) {
            return face->direction == (side == kBelow ? -cut_face.direction : cut_face.direction);
        });
        if (met == faces.end()) {
            join_unpaired(cut_face.item + cut_face_side);
        } else {
            sets.join((*met)->item, cut_face.item + cut_face_side);
            faces.erase(met);
        }
    }
    for (const EdgeUse* face : faces)
        join_unpaired(face->item);
}

/// Joins pieces that meet along an edge. Where cut faces end at an edge each of them closes the
/// part whose face it meets there. False where one part would use an edge four times, though the
/// model's cells use theirs twice: then those edges are among the dissolved, to be tried again
/// without.
bool CellCutter::find_parts(std::span<const PieceRef> refs, CellCut& result) {
    const auto pieces = static_cast<std::int32_t>(refs.size());
    const std::size_t count = refs.size() + 2 * result.cut_faces.size();
    add_uses_of_cut_faces(result.cut_faces, pieces);
    DisjointSets sets(count);
    for (const auto of_edge : groups_of(uses_, &EdgeUse::key)) {
        for (const std::int8_t side : {kBelow, kAbove})
            join_at_edge(of_edge, side, sets);
    }
    attach_hollows(refs, result, sets);
    std::vector<std::int32_t> root(count);
    for (std::size_t i = 0; i < count; ++i)
        root[i] = sets.find(static_cast<std::int32_t>(i));
    // a part that rounding has turned inside out may meet the one that it goes to along an edge
    if (model_.cell_kind != CellKind::kBlocks && !use_edges_twice(root, pieces)) return false;

    result.part.assign(count, -1);
    result.part_side.clear();
    std::vector<std::int32_t> number(count, -1);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int8_t side = side_of(static_cast<std::int32_t>(i));
        auto& part = number[index(root[i])];
        if (part < 0) {
            part = static_cast<std::int32_t>(result.part_side.size());
            result.part_side.push_back(side);
        }
        assert(result.part_side[index(part)] == side);
        result.part[i] = part;
    }
    return true;
}

/// Whether each part uses its edges twice. If not, what was done at them is noted to be done
/// otherwise: slits are dissolved; where rounding has folded a cut face over itself, its loops stay
/// undivided.
bool CellCutter::use_edges_twice(const std::vector<std::int32_t>& root, std::int32_t pieces) {
    const std::size_t dissolved_before = dissolved_.size();
    bool folded = false;
    std::vector<std::int32_t> parts;
    for (const auto of_edge : groups_of(uses_, &EdgeUse::key)) {
        parts.clear();
        for (const EdgeUse& use : of_edge) {
            parts.push_back(root[index(use.item)]);
            if (use.item >= pieces) parts.push_back(root[index(use.item + 1)]);
        }
        std::sort(parts.begin(), parts.end());
        bool often = false;
        for (std::size_t i = 2; i < parts.size(); ++i)
            often = often || parts[i] == parts[i - 2];
        if (!often) continue;
        if (std::ranges::find(slits_, of_edge[0].edge) != slits_.end()) {
            dissolved_.push_back(of_edge[0].edge);
        } else {
            folded = true;
        }
    }
    std::sort(dissolved_.begin(), dissolved_.end());
    if (dissolved_.size() > dissolved_before) return false;
    if (!folded || whole_loops_) return true;  // the model's cell may use an edge more often itself
    whole_loops_ = true;
    return false;
}

/// Joins the walls of hollows within parts with the parts around them.
void CellCutter::attach_hollows(std::span<const PieceRef> refs, const CellCut& result,
                                DisjointSets& sets) const {
    const auto count = static_cast<std::int32_t>(refs.size() + 2 * result.cut_faces.size());
    std::vector<Position> corners;
    for (const std::int8_t side : {kBelow, kAbove}) {
        std::vector<std::int32_t> items;
        for (std::int32_t i = 0; i < count; ++i) {
            if (side_of(i) == side) items.push_back(i);
        }
        join_hollows(items, sets, [&](std::int32_t item, const VisitShellPolygon& visit) {
            const std::size_t i = index(item);
            const bool is_cut_face = i >= refs.size();
            const bool reversed = is_cut_face ? side == kAbove : refs[i].which == 1;
            corners.clear();
            for (const NodeId node : is_cut_face ? result.cut_faces[(i - refs.size()) / 2]
                                                 : pieces_.polygons[index(refs[i].piece)])
                corners.push_back(points_.rounded(node));
            visit(corners, reversed ? -1 : 1);
        });
    }
}

}  // namespace realmodel::cutting
