// SPDX-License-Identifier: GPL-3.0-or-later
// Where the regions of a cutting surface lie, the parts that they divide cells into, and their
// sides.
#include "surface_cut.hpp"

#include <algorithm>
#include <cmath>

#include "model_check.hpp"
#include "plane_sides.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

namespace {

std::vector<NodeId> from_least(std::vector<NodeId> loop) {
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    return loop;
}

}  // namespace

Cut SurfaceCut::cut() {
    find_active_faces();
    name_vertices();
    overlay_all();
    name_nodes();
    if (progress_ != nullptr) progress_->report(0.6, "finding the parts of cells");
    find_level_regions();
    locate_caps();
    join_parts();
    attach_hollows();
    label_parts();
    make_pieces();
    number_cells();
    make_distinct();
    const std::array<bool, 2> touches = verify();
    if (progress_ != nullptr) progress_->report(0.8, "putting the halves together");
    Cut halves =
        assemble_halves(model_, new_positions_, pieces_, parts_, half_cells_, threads_, progress_);
    halves.below_touches = touches[0];
    halves.above_touches = touches[1];
    return halves;
}

/// Regions of faces that are regions of the surface too.
void SurfaceCut::find_level_regions() {
    const std::size_t count = regions().size();
    level_.assign(count, -1);
    level_turn_.assign(count, 0);
    used_up_.assign(count, 0);
    std::map<std::vector<NodeId>, std::int32_t> outlines;
    for (std::size_t r = 0; r < count; ++r) {
        if (is_cap_region(r))
            outlines.emplace(from_least(loops_[r][0]), static_cast<std::int32_t>(r));
    }
    for (std::size_t r = 0; r < count; ++r) {
        if (is_cap_region(r)) continue;
        std::vector<NodeId> outline = loops_[r][0];
        for (const std::int8_t turn : {1, -1}) {
            const auto found = outlines.find(from_least(outline));
            if (found != outlines.end()) {
                level_[r] = found->second;
                level_turn_[r] = turn;
                used_up_[index(found->second)] = 1;
                break;
            }
            std::reverse(outline.begin(), outline.end());
        }
    }
}

/// The exact point of a node of the result.
NodeId SurfaceCut::exact_node(NodeId node) {
    const auto vertices = static_cast<NodeId>(model_.vertex_count());
    if (node >= vertices) return exact_of_new_[index(node - vertices)];
    NodeId& known = vertex_node_[index(node)];
    if (known < 0) known = points_.add(model_.vertex(node));
    return known;
}

/// The corner of a face that is farthest from the line of one of its edges.
NodeId SurfaceCut::far_corner(std::size_t face, const std::array<NodeId, 2>& edge) const {
    const Position a = model_.vertex(edge[0]), b = model_.vertex(edge[1]);
    NodeId found = edge[0];
    double farthest = -1;
    for (const NodeId v : model_.face(face)) {
        const std::array corners{a, b, model_.vertex(v)};
        const Position normal = polygon_normal(corners);
        const double away = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        if (away > farthest) {
            farthest = away;
            found = v;
        }
    }
    return found;
}

/// The numbers of uses of one edge in the order in which they stand around it: counted from the
/// first, counter-clockwise for one who looks along the edge from its lesser node with up to the
/// left of right.
std::vector<std::size_t> SurfaceCut::round_edge(std::span<const Use> uses) {
    const NodeId a = exact_node(uses[0].edge[0]), b = exact_node(uses[0].edge[1]);
    std::vector<NodeId> towards;
    for (const Use& use : uses) {
        if (index(use.item) >= regions().size()) {
            towards.push_back(exact_node(far_corner(index(use.item) - regions().size(), use.edge)));
            continue;
        }
        const std::int32_t triangle = regions()[index(use.item)].triangle;
        towards.push_back(use.direction > 0 ? overlay_.left_corner(triangle, a, b)
                                            : overlay_.left_corner(triangle, b, a));
    }
    std::size_t axis = 0;
    while (axis < 2 && points_.turn(axis, a, b, towards[0]) == 0)
        ++axis;
    const int first_turn = points_.turn(axis, a, b, towards[0]);
    std::vector<int> quarter;
    for (const NodeId p : towards) {
        const int o = points_.orientation(a, b, towards[0], p);
        if (o != 0) {
            quarter.push_back(o < 0 ? 1 : 3);
        } else {
            quarter.push_back(points_.turn(axis, a, b, p) == first_turn ? 0 : 2);
        }
    }
    std::vector<std::size_t> order(uses.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        if (quarter[i] != quarter[j]) return quarter[i] < quarter[j];
        if (quarter[i] % 2 == 0) return false;
        return points_.orientation(a, b, towards[i], towards[j]) < 0;
    });
    return order;
}

/// The cell beyond a face's region, going round one of its edges counter-clockwise.
std::int32_t SurfaceCut::cell_after(const Use& use) const {
    const auto face = index(face_of_[index(regions()[index(use.item)].triangle)]);
    return model_.cell(face, use.direction > 0 ? 0 : 1);
}

/// The cells that the surface's regions lie in: told by the faces around an edge that they share
/// with some; handed on to the regions around it.
void SurfaceCut::locate_caps() {
    const std::size_t count = regions().size();
    std::vector<std::array<NodeId, 2>> edges;
    const auto each_edge = [&](std::size_t r, const auto& visit) {
        for (const auto& loop : loops_[r]) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                visit(Use{{std::min(a, b), std::max(a, b)},
                          static_cast<std::int32_t>(r),
                          static_cast<std::int8_t>(a < b ? 1 : -1)});
            }
        }
    };
    for (std::size_t r = 0; r < count; ++r) {
        if (is_cap_region(r)) each_edge(r, [&](const Use& use) { edges.push_back(use.edge); });
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (std::size_t r = 0; r < count; ++r) {
        if (used_up_[r] != 0) continue;
        each_edge(r, [&](const Use& use) {
            if (std::binary_search(edges.begin(), edges.end(), use.edge)) uses_.push_back(use);
        });
    }
    std::sort(uses_.begin(), uses_.end());

    strata::DisjointParts sets(count);
    cap_cell_.assign(count, -1);
    std::vector<std::uint8_t> told(count, 0);
    std::vector<std::int32_t> told_cell(count, -1);
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        while (end < uses_.size() && uses_[end].edge == uses_[begin].edge)
            ++end;
        const std::span<const Use> group(uses_.data() + begin, end - begin);
        const auto is_cap = [&](const Use& use) { return is_cap_region(index(use.item)); };
        const auto caps = std::count_if(group.begin(), group.end(), is_cap);
        if (caps == 0) continue;
        if (static_cast<std::size_t>(caps) == group.size()) {
            for (const Use& use : group)
                sets.join(group[0].item, use.item);
            continue;
        }
        const auto order = round_edge(group);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Use& use = group[order[i]];
            if (!is_cap(use)) continue;
            std::size_t before = i;
            do {
                before = (before + order.size() - 1) % order.size();
            } while (is_cap(group[order[before]]));
            if (told[index(use.item)] != 0) continue;
            told[index(use.item)] = 1;
            told_cell[index(use.item)] = cell_after(group[order[before]]);
        }
    }
    std::vector<std::int32_t> told_by(count, -1);  // of sets: the first region that knows
    for (std::size_t r = 0; r < count; ++r) {
        const auto root = index(sets.find(static_cast<std::int32_t>(r)));
        if (told[r] != 0 && told_by[root] < 0) told_by[root] = static_cast<std::int32_t>(r);
    }
    for (std::size_t r = 0; r < count; ++r) {
        if (!is_cap_region(r) || used_up_[r] != 0) continue;
        const auto root = index(sets.find(static_cast<std::int32_t>(r)));
        if (told_by[root] < 0) {  // it touches no face: it lies within one cell, or outside
            told_by[root] = static_cast<std::int32_t>(r);
            told_cell[r] =
                cell_around(new_positions_.empty() ? Position{} : position(loops_[r][0][0]));
        }
        cap_cell_[r] = told_cell[index(told_by[root])];
    }
}

/// The cell that a place which is on no face lies in, -1 outside: how often a ray from it crosses
/// the cell's faces.
std::int32_t SurfaceCut::cell_around(const Position& p) const {
    const Position way{0.13717, 0.29153, 0.94662};
    std::vector<std::uint8_t> odd(model_.cell_block.size(), 0);
    const auto at = [&](NodeId v) {
        const Position q = model_.vertex(v);
        return Position{q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    };
    // on which side the ray passes an edge: told the same way by both triangles of the edge
    const auto passes = [&](NodeId v, NodeId w) {
        const bool turned = v > w;
        const Position a = at(turned ? w : v), b = at(turned ? v : w);
        const double side = way[0] * (a[1] * b[2] - a[2] * b[1]) +
                            way[1] * (a[2] * b[0] - a[0] * b[2]) +
                            way[2] * (a[0] * b[1] - a[1] * b[0]);
        return (side >= 0) != turned;
    };
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        const auto face = model_.face(f);
        bool crossed = false;
        for (std::size_t i = 1; i + 1 < face.size(); ++i) {
            const bool side = passes(face[0], face[i]);
            if (passes(face[i], face[i + 1]) != side || passes(face[i + 1], face[0]) != side)
                continue;
            const Position a = at(face[0]), b = at(face[i]), c = at(face[i + 1]);
            const std::array corners{a, b, c};
            const Position normal = polygon_normal(corners);
            const double slope = normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2];
            const double height = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2];
            if (height * slope > 0) crossed = !crossed;
        }
        if (!crossed) continue;
        for (std::size_t k = 0; k < 2; ++k) {
            if (model_.cell(f, k) >= 0) odd[index(model_.cell(f, k))] ^= 1;
        }
    }
    const auto found = std::find(odd.begin(), odd.end(), 1);
    return found == odd.end() ? -1 : static_cast<std::int32_t>(found - odd.begin());
}

/// Joins the sides of faces and caps that bound the same part of a cell.
void SurfaceCut::join_parts() {
    const std::size_t count = regions().size();
    sets_ = std::make_unique<strata::DisjointParts>(2 * (count + model_.face_count()));
    is_cut_.assign(model_.cell_block.size(), 0);
    for (const std::int32_t cell : cap_cell_) {
        if (cell >= 0) is_cut_[index(cell)] = 1;
    }
    std::vector<std::int32_t> first(is_cut_.size(), -1);
    std::vector<CellUse> uses;
    const auto take = [&](std::size_t item, std::size_t face, const auto& loops) {
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t cell = model_.cell(face, k);
            if (cell < 0) continue;
            const auto own = static_cast<std::int32_t>(slot(static_cast<std::int32_t>(item), k));
            if (is_cut_[index(cell)] == 0) {
                auto& known = first[index(cell)];
                if (known < 0) known = own;
                sets_->join(known, own);
                continue;
            }
            for (const auto& loop : loops) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                    uses.push_back({cell,
                                    {{std::min(a, b), std::max(a, b)},
                                     static_cast<std::int32_t>(item),
                                     static_cast<std::int8_t>(a < b ? 1 : -1)}});
                }
            }
        }
    };
    for (std::size_t r = 0; r < count; ++r) {
        if (!is_cap_region(r)) {
            take(r, index(face_of_[index(regions()[r].triangle)]), loops_[r]);
        } else if (cap_cell_[r] >= 0) {
            for (const auto& loop : loops_[r]) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                    uses.push_back({cap_cell_[r],
                                    {{std::min(a, b), std::max(a, b)},
                                     static_cast<std::int32_t>(r),
                                     static_cast<std::int8_t>(a < b ? 1 : -1)}});
                }
            }
        }
    }
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        if (active_[f] == 0) take(item_of_face(f), f, std::array{model_.face(f)});
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        while (end < uses.size() && uses[end].cell == uses[begin].cell &&
               uses[end].use.edge == uses[begin].use.edge)
            ++end;
        join_round_edge({uses.data() + begin, end - begin});
    }
}

void SurfaceCut::join_round_edge(std::span<const CellUse> uses) {
    const std::int32_t cell = uses[0].cell;
    std::vector<Use> group;
    bool caps = false;
    for (const CellUse& use : uses) {
        group.push_back(use.use);
        const auto item = index(use.use.item);
        caps = caps || (item < regions().size() && is_cap_region(item));
    }
    /// The side of a use's item that looks clockwise (0) or counter-clockwise (1) and into the
    /// cell, as a slot; -1 where that is another cell.
    const auto facing = [&](const Use& use, std::size_t ahead) -> std::int32_t {
        const std::size_t which = (use.direction > 0) == (ahead == 1) ? 0 : 1;
        const auto item = index(use.item);
        if (item < regions().size() && is_cap_region(item))
            return static_cast<std::int32_t>(slot(use.item, which));
        const auto face = item < regions().size() ? index(face_of_[index(regions()[item].triangle)])
                                                  : item - regions().size();
        return model_.cell(face, which) == cell ? static_cast<std::int32_t>(slot(use.item, which))
                                                : -1;
    };
    if (!caps && group.size() == 2) {  // two faces: the part between them, wherever they stand
        std::array<std::int32_t, 2> own{};
        for (std::size_t i = 0; i < 2; ++i)
            own[i] = std::max(facing(group[i], 0), facing(group[i], 1));
        sets_->join(own[0], own[1]);
        return;
    }
    const auto order = round_edge(group);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::int32_t ahead = facing(group[order[i]], 1);
        const std::int32_t back = facing(group[order[(i + 1) % order.size()]], 0);
        if (ahead >= 0 && back >= 0) sets_->join(ahead, back);
    }
}

/// One part would lie on both sides. Where an edge of the surface's border lies within the model
/// that is why; otherwise things cross that should not.
void SurfaceCut::refuse_open(std::size_t region) const {
    std::vector<std::array<NodeId, 2>> edges;
    for (std::size_t r = 0; r < regions().size(); ++r) {
        if (!is_cap_region(r) || (cap_cell_[r] < 0 && used_up_[r] == 0)) continue;
        for (const auto& loop : loops_[r]) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                edges.push_back({std::min(a, b), std::max(a, b)});
            }
        }
    }
    std::sort(edges.begin(), edges.end());
    const auto on_outside = [this](const std::array<NodeId, 2>& edge) {
        for (std::size_t r = 0; r < regions().size(); ++r) {
            if (is_cap_region(r)) continue;
            if (model_.cell(index(face_of_[index(regions()[r].triangle)]), 1) >= 0) continue;
            for (const auto& loop : loops_[r]) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                    if (std::min(a, b) == edge[0] && std::max(a, b) == edge[1]) return true;
                }
            }
        }
        return false;
    };
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool alone = (i == 0 || edges[i - 1] != edges[i]) &&
                           (i + 1 == edges.size() || edges[i + 1] != edges[i]);
        if (!alone || on_outside(edges[i])) continue;
        const Position p = position(edges[i][0]), q = position(edges[i][1]);
        throw InputError(
            "ends_inside", "the surface does not part the model: it ends inside of it", -1, {},
            Position{p[0] + (q[0] - p[0]) / 2, p[1] + (q[1] - p[1]) / 2, p[2] + (q[2] - p[2]) / 2});
    }
    throw InputError("unresolved",
                     "the surface that cuts crosses itself, or the model does within its rounding",
                     -1, {}, position(loops_[region][0][0]));
}

/// The side of each part: caps know it, faces that lie on the surface know it, and it is handed on
/// through all other faces. What is not connected with the surface lies on the side of its nearest
/// triangle.
void SurfaceCut::label_parts() {
    const std::size_t count = regions().size();
    const std::size_t slots = 2 * (count + model_.face_count());
    strata::DisjointParts bodies(slots);
    for (std::size_t s = 0; s < slots; ++s)
        bodies.join(static_cast<std::int32_t>(s), sets_->find(static_cast<std::int32_t>(s)));
    const auto pass = [&](std::size_t item, std::size_t face) {
        if (model_.cell(face, 1) >= 0) {
            const auto number = static_cast<std::int32_t>(item);
            bodies.join(static_cast<std::int32_t>(slot(number, 0)),
                        static_cast<std::int32_t>(slot(number, 1)));
        }
    };
    for (std::size_t r = 0; r < count; ++r) {
        if (!is_cap_region(r) && level_[r] < 0)
            pass(r, index(face_of_[index(regions()[r].triangle)]));
    }
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        if (active_[f] == 0) pass(item_of_face(f), f);
    }
    side_.assign(slots, kOn);
    const auto label = [&](std::size_t region, std::size_t which, std::int8_t side) {
        auto& known = side_[index(bodies.find(
            static_cast<std::int32_t>(slot(static_cast<std::int32_t>(region), which))))];
        if (known == -side && known != kOn) refuse_open(region);
        known = side;
    };
    for (std::size_t r = 0; r < count; ++r) {
        if (is_cap_region(r)) {
            if (cap_cell_[r] < 0) continue;
            label(r, 0, kBelow);
            label(r, 1, kAbove);
        } else if (level_[r] >= 0) {
            const auto face = index(face_of_[index(regions()[r].triangle)]);
            const std::int8_t first = level_turn_[r] > 0 ? kBelow : kAbove;
            label(r, 0, first);
            if (model_.cell(face, 1) >= 0) label(r, 1, static_cast<std::int8_t>(-first));
        }
    }
    // of bodies away from the surface, the vertex of a face that is farthest from its edges' sake
    const auto locate = [&](std::size_t item, std::size_t face) {
        auto& known = side_[index(
            bodies.find(static_cast<std::int32_t>(slot(static_cast<std::int32_t>(item), 0))))];
        if (known != kOn) return;
        Position middle{0, 0, 0};
        const auto corners = model_.face(face);
        for (const NodeId v : corners) {
            for (std::size_t k = 0; k < 3; ++k)
                middle[k] += model_.vertex(v)[k] / static_cast<double>(corners.size());
        }
        known = side_of_nearest(surface_, middle);
    };
    for (std::size_t r = 0; r < count; ++r) {
        if (!is_cap_region(r)) locate(r, index(face_of_[index(regions()[r].triangle)]));
    }
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        if (active_[f] == 0) locate(item_of_face(f), f);
    }
    std::vector<std::int8_t> by_part(slots);
    for (std::size_t s = 0; s < slots; ++s)
        by_part[s] = side_[index(bodies.find(static_cast<std::int32_t>(s)))];
    side_ = std::move(by_part);
}

namespace {

bool is_same(const ComplexView& one, const ComplexView& other) {
    const auto equal = [](const auto& a, const auto& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    };
    return equal(one.vertices, other.vertices) && equal(one.face_vertices, other.face_vertices) &&
           equal(one.face_offsets, other.face_offsets) && equal(one.face_cells, other.face_cells) &&
           equal(one.cell_block, other.cell_block);
}

/// A model's own block taken out of it: no cell is cut.
Cut part_by_block(const ComplexView& model, std::int32_t block, int threads, Progress* progress) {
    if (std::find(model.cell_block.begin(), model.cell_block.end(), block) ==
        model.cell_block.end())
        throw InputError("no_block", "the block that is to cut has no cells", -1, {block});
    Pieces pieces;
    PieceParts parts;
    std::vector<HalfCell> cells;
    const auto side = [&](std::int32_t cell) {
        return cell < 0 ? kOn : model.block(cell) == block ? kBelow : kAbove;
    };
    for (std::size_t c = 0; c < model.cell_block.size(); ++c) {
        const auto cell = static_cast<std::int32_t>(c);
        cells.push_back({cell, side(cell)});
    }
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        const std::array<std::int32_t, 2> own{model.cell(f, 0), model.cell(f, 1)};
        pieces.polygons.add(model.face(f));
        pieces.face.push_back(static_cast<std::int32_t>(f));
        pieces.cells.push_back(own);
        pieces.sides.push_back({side(own[0]), side(own[1])});
        const bool bounds =
            (pieces.sides.back()[0] == kBelow) != (pieces.sides.back()[1] == kBelow);
        pieces.level.push_back(bounds ? 1 : 0);
        parts.push_back(own);
    }
    return assemble_halves(model, {}, pieces, parts, cells, threads, progress);
}

}  // namespace

Cut cut_by_surface(const ComplexView& model, const TriangleView& surface, int threads,
                   Progress* progress) {
    check_model(model);
    return SurfaceCut(model, oriented_surface(surface), threads, progress).cut();
}

Cut cut_by_block(const ComplexView& model, const ComplexView& other, std::int32_t block,
                 int threads, Progress* progress) {
    check_model(model);
    check_model(other);
    if (is_same(model, other)) return part_by_block(model, block, threads, progress);
    return SurfaceCut(model, block_boundary(other, block), threads, progress).cut();
}

}  // namespace realmodel::cutting
