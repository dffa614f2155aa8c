// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/part_rounding.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "arrangement/triangulate.hpp"
#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

namespace {

/// Whether all that is around a part is one other part, which has nothing else around itself.
bool has_one_neighbor(const RoundedParts& parts, std::int32_t part) {
    const auto around = parts.pieces_of[index(part)];
    const auto beyond = [&](std::int32_t p) {
        const CutPiece& piece = parts.pieces[index(p)];
        return piece.sides[0] == piece.sides[1] ? piece.parts[piece.parts[0] == part ? 1 : 0] : -1;
    };
    if (around.empty()) return false;
    const std::int32_t other = beyond(around[0]);
    return other >= 0 && other != part && parts.pieces_of[index(other)].size() == around.size() &&
           std::ranges::all_of(around, [&](std::int32_t p) { return beyond(p) == other; });
}

}  // namespace

void drop_hollow(RoundedParts& parts) {
    CutPieces& pieces = parts.pieces;
    bool any = false;
    for (std::size_t part = 0; part < parts.half_cells.size(); ++part) {
        const auto around = parts.pieces_of[part];
        const auto number = static_cast<std::int32_t>(part);
        if (parts.has_far_faces[part] != 0) continue;
        if (has_one_neighbor(parts, number)) {
            any = true;
            for (const std::int32_t p : around)
                pieces[index(p)].parts = {-1, -1};
        }
        if (around.size() != 2) continue;
        const std::array both{index(around[0]), index(around[1])};
        const bool has_both = both[0] != both[1] && std::ranges::all_of(both, [&](std::size_t p) {
                                  return std::ranges::count(pieces[p].parts, number) == 1;
                              });
        if (!has_both) continue;
        assert(std::ranges::is_permutation(pieces.polygons[both[0]], pieces.polygons[both[1]]));
        any = true;
        std::array<std::size_t, 2> which{};
        std::array<std::int32_t, 2> beyond{};  // the parts of this half there, or none
        for (std::size_t k = 0; k < 2; ++k) {
            which[k] = pieces[both[k]].parts[0] == number ? 0 : 1;
            const auto& sides = pieces[both[k]].sides;
            beyond[k] = sides[0] == sides[1] ? pieces[both[k]].parts[1 - which[k]] : -1;
        }
        const std::size_t stays = beyond[0] < 0 ? 0 : 1, goes = 1 - stays;
        const std::int32_t next = beyond[goes] == beyond[stays] ? -1 : beyond[goes];
        pieces[both[stays]].parts[which[stays]] = next;
        pieces[both[goes]].parts[which[goes]] = -1;
        if (next >= 0) {
            pieces[both[stays]].cells[which[stays]] = parts.half_cells[index(next)].cell;
            pieces[both[goes]].parts = {-1, -1};
        } else if (beyond[stays] >= 0) {
            pieces[both[stays]].parts = pieces[both[goes]].parts = {-1, -1};
        }
    }
    if (any) parts.update();
}

void level_base(RoundedParts& parts) {
    for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
        if (parts.surface_of(p, kCutFace) != kBase) continue;
        const NodeId first = parts.model.face(index(parts.pieces[p].face))[0];
        for (const NodeId node : parts.pieces.polygons[p]) {
            if (parts.is_new(node)) parts.moving(node)[2] = parts.at(first)[2];
        }
    }
}

namespace {

/// Has new nodes become the vertex of the model, or else the first new node, in their position.
/// @return these nodes
std::vector<NodeId> contract(const RoundedParts& parts, std::vector<NodeId>& becomes) {
    const auto& positions = parts.new_positions;
    const auto is_at = [&positions](const Position& p) {
        return [&positions, &p](std::int32_t i) { return positions[index(i)] == p; };
    };
    KeyTable first;  // of the new nodes in one position
    first.reserve(positions.size());
    spatial::Box box;
    const std::size_t vertices = parts.vertices.size();
    for (std::size_t i = 0; i < positions.size(); ++i) {
        box.include(positions[i]);
        const auto entry = first.find_or_add(Positions::hash(positions[i]),
                                             static_cast<std::int32_t>(i), is_at(positions[i]));
        becomes[vertices + i] = static_cast<NodeId>(vertices) + entry.number;
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        const Position& p = parts.vertices[v];
        if (!box.contains(p)) continue;
        const std::int32_t new_node = first.find(Positions::hash(p), is_at(p));
        if (new_node >= 0) becomes[vertices + index(new_node)] = static_cast<NodeId>(v);
    }
    std::vector<NodeId> contracted;
    for (std::size_t node = vertices; node < becomes.size(); ++node) {
        becomes[node] = becomes[index(becomes[node])];  // the first in a position: a vertex there
        if (index(becomes[node]) != node) contracted.push_back(static_cast<NodeId>(node));
    }
    return contracted;
}

/// Takes contractions back until all parts around those that are left stay sound.
void keep_sound(const RoundedParts& parts, Contraction& contraction,
                const std::vector<NodeId>& contracted, const std::array<bool, 2>& touches) {
    auto& becomes = contraction.becomes;
    const CutPieces& pieces = parts.pieces;
    std::vector<std::uint8_t> is_involved(becomes.size(), 0);
    for (const NodeId node : contracted)
        is_involved[index(node)] = is_involved[index(becomes[index(node)])] = 1;
    std::set<std::int32_t> involved;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (std::ranges::none_of(pieces.polygons[p],
                                 [&](NodeId node) { return is_involved[index(node)] != 0; }))
            continue;
        for (const std::int32_t part : pieces[p].parts) {
            if (part >= 0) involved.insert(part);
        }
    }
    const auto stays_sound = [&](std::int32_t part, Contraction::ShapeScratch& scratch) {
        const auto shape = contraction.shape(part, scratch);
        return shape && contraction.is_sound(*shape, part) &&
               (shape->touches == 0 || parts.model.cell_kind == CellKind::kBlocks ||
                touches[parts.half_cells[index(part)].side == kAbove ? 1 : 0]);
    };
    // what all of them are like at first is found on all threads
    const std::vector<std::int32_t> all(involved.begin(), involved.end());
    std::vector<std::uint8_t> is_sound(all.size());
    constexpr std::size_t kAtOnce = 1 << 6;
    parallel_workers((all.size() + kAtOnce - 1) / kAtOnce, parts.execution,
                     [&] {
                         return [&,
                                 scratch = Contraction::ShapeScratch()](std::size_t chunk) mutable {
                             const std::size_t end = std::min(all.size(), (chunk + 1) * kAtOnce);
                             for (std::size_t i = chunk * kAtOnce; i < end; ++i)
                                 is_sound[i] = stays_sound(all[i], scratch) ? 1 : 0;
                         };
                     },
                     0.02);
    std::set<std::int32_t> open;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (is_sound[i] == 0) open.insert(all[i]);
    }
    if (open.empty()) return;
    const auto for_each_contracted = [&](std::int32_t part, const auto& visit) {
        for (const std::int32_t piece : parts.pieces_of[index(part)]) {
            for (const NodeId node : pieces.polygons[index(piece)]) {
                if (becomes[index(node)] != node) visit(node);
            }
        }
    };
    std::map<NodeId, std::set<std::int32_t>> parts_at;
    for (const std::int32_t part : all)
        for_each_contracted(part, [&](NodeId node) { parts_at[node].insert(part); });
    Contraction::ShapeScratch scratch;
    while (!open.empty()) {
        const std::int32_t part = *open.begin();
        open.erase(open.begin());
        if (stays_sound(part, scratch)) continue;
        // its nodes stay apart; the parts around these are looked at again
        for_each_contracted(part, [&](NodeId node) {
            becomes[index(node)] = node;
            open.insert(parts_at[node].begin(), parts_at[node].end());
        });
        open.erase(part);
    }
}

}  // namespace

void join_coincident(RoundedParts& parts, const std::array<bool, 2>& touches, bool may_fold) {
    Contraction contraction(parts, may_fold);
    const std::vector<NodeId> nodes = contract(parts, contraction.becomes);
    if (nodes.empty()) return;
    keep_sound(parts, contraction, nodes, touches);
    contraction.apply();
}

void separate_coincident_nodes(RoundedParts& parts) {
    spatial::Box box = spatial::bounding_box(parts.new_positions);
    parts.taken.reserve(2 * parts.new_positions.size());
    if (!parts.new_positions.empty()) box.widen(16 * rounding_of(std::array{box.low, box.high}));
    for (const Position& p : parts.vertices) {
        if (box.contains(p)) parts.taken.insert(p);
    }
    std::vector<std::uint8_t> is_used(parts.vertices.size() + parts.new_positions.size(), 0);
    for (const NodeId node : parts.pieces.polygons.nodes)
        is_used[index(node)] = 1;
    for (std::size_t n = parts.vertices.size(); n < is_used.size(); ++n) {
        const auto node = static_cast<NodeId>(n);
        Position& p = parts.moving(node);
        if (is_used[n] != 0 && !parts.taken.insert(p))
            p = free_position_beside(p, parts.freedom_of(std::array{node}), parts.taken);
    }
}

namespace {

/// Calls visit(i) one after another for those of so many things that are what is asked for then: a
/// visit may change what others are. The first of them is found on several threads.
template <class IsIt, class Visit>
void visit_where(const RoundedParts& parts, std::size_t count, const IsIt& is_it,
                 const Visit& visit) {
    const auto at_first = collect_items<std::size_t>(
        count, parts.execution, [&](std::size_t i, std::vector<std::size_t>& list) {
            if (is_it(i)) list.push_back(i);
        });
    for (std::size_t i = at_first.empty() ? count : at_first[0]; i < count; ++i) {
        if (is_it(i)) visit(i);
    }
}

/// Moves one of some new nodes up along an axis to a free position.
/// @param may_leave  whether it may go off the base or its walls
bool widen(RoundedParts& parts, std::span<const NodeId> nodes, std::size_t axis, bool may_leave) {
    constexpr int kUnits = 3;  // in the last place, that are tried
    for (const NodeId node : nodes) {
        const auto& bound = axis == 2 ? parts.on_base : parts.on_wall;
        if (!parts.is_new(node) || (!may_leave && bound[index(node)] != 0)) continue;
        Position to = parts.at(node);
        for (int i = 0; i < kUnits; ++i) {
            to[axis] = std::nextafter(to[axis], HUGE_VAL);
            if (!parts.taken.insert(to)) continue;
            parts.moving(node) = to;
            return true;
        }
    }
    return false;
}

}  // namespace

void widen_flat_parts(RoundedParts& parts) {
    const auto flat_axes = [&](std::size_t part) {
        std::vector<std::size_t> axes;
        if (!parts.is_changed(static_cast<std::int32_t>(part)) || parts.has_far_faces[part] != 0)
            return axes;
        spatial::Box box;
        for (const std::int32_t piece : parts.pieces_of[part]) {
            for (const NodeId node : parts.pieces.polygons[index(piece)])
                box.include(parts.at(node));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (box.low[axis] == box.high[axis]) axes.push_back(axis);
        }
        return axes;
    };
    const auto is_thin = [&](std::size_t part) { return !flat_axes(part).empty(); };
    visit_where(parts, parts.half_cells.size(), is_thin, [&](std::size_t part) {
        std::vector<NodeId> nodes;
        for (const std::int32_t piece : parts.pieces_of[part]) {
            const auto polygon = parts.pieces.polygons[index(piece)];
            nodes.insert(nodes.end(), polygon.begin(), polygon.end());
        }
        for (const std::size_t axis : flat_axes(part)) {
            if (!widen(parts, nodes, axis, false)) widen(parts, nodes, axis, true);
        }
    });
    const auto is_upright = [&](std::size_t p) { return parts.is_upright(p); };
    visit_where(parts, parts.pieces.size(), is_upright, [&](std::size_t p) {
        const auto nodes = parts.pieces.polygons[p];
        if (!widen(parts, nodes, 0, true)) widen(parts, nodes, 1, true);
    });
}

namespace {

/// A piece, and the one of its sides that is within a half where the other side is not.
struct OuterPiece {
    std::size_t piece, which;
    int winding;
};

/// Of equal polygons of one half: those that face each other from outside of it become one between
/// their parts, which is added to `glued`, or none in one part. Whether there were any.
bool glue(RoundedParts& parts, std::span<const std::size_t> equal, std::int8_t half,
          CutPieces& glued, std::vector<std::uint8_t>& is_doubled) {
    CutPieces& pieces = parts.pieces;
    bool any = false;
    std::vector<OuterPiece> outers;
    for (const std::size_t p : equal) {
        const auto& sides = pieces[p].sides;
        for (std::size_t k = 0; k < 2; ++k) {
            if (pieces[p].parts[k] < 0 || sides[k] != half) continue;
            if (pieces[p].parts[1 - k] >= 0 && sides[1 - k] == half) continue;
            const int winding = winding_of(pieces.polygons[p]);
            const OuterPiece outer{p, k, k == 0 ? winding : -winding};
            const auto against = std::ranges::find(outers, -outer.winding, &OuterPiece::winding);
            if (against == outers.end()) {
                if (!outers.empty()) is_doubled[p] = 1;
                outers.push_back(outer);
                continue;
            }
            any = true;
            const std::array met{pieces[against->piece].parts[against->which], pieces[p].parts[k]};
            if (met[0] != met[1]) {
                const auto cell = [&](std::size_t i) {
                    return parts.half_cells[index(met[i])].cell;
                };
                const CutPiece between{-1, {cell(0), cell(1)}, {half, half}, false, met};
                const auto nodes = pieces.polygons[against->piece];
                if (against->which == 1) {
                    glued.add_reversed(nodes, between);
                } else {
                    glued.add(nodes, between);
                }
            }
            pieces[against->piece].parts[against->which] = pieces[p].parts[k] = -1;
            outers.erase(against);
        }
    }
    return any;
}

}  // namespace

std::vector<std::uint8_t> merge_coincident_faces(RoundedParts& parts) {
    CutPieces glued;
    std::vector<std::uint8_t> is_doubled(parts.pieces.size(), 0);
    bool any = false;
    for (const auto& equal : equal_pieces(parts)) {
        for (const std::int8_t half : {kBelow, kAbove})
            any = glue(parts, equal, half, glued, is_doubled) || any;
    }
    if (!any) return is_doubled;
    std::vector<std::uint8_t> glued_doubled(glued.size(), 0);
    for (std::size_t p = 0; p < is_doubled.size(); ++p) {
        if (parts.pieces[p].parts[0] < 0 && parts.pieces[p].parts[1] < 0) continue;
        glued.add(parts.pieces.polygons[p], parts.pieces[p]);
        glued_doubled.push_back(is_doubled[p]);
    }
    parts.replace_pieces(std::move(glued));
    drop_hollow(parts);
    return glued_doubled;
}

namespace {

/// Whether a polygon turns one way and rises and falls once on both axes, but for rounding.
bool is_nearly_convex(std::span<const PlanePosition> corners, const PlanePosition& rounding) {
    bool left = true, right = true;
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
        const PlanePosition &a = corners[i], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
        const double turn = cross(minus(b, a), minus(c, b));
        const double allowed = arrangement::slack(a, b, c, rounding);
        left = left && turn >= -allowed;
        right = right && turn <= allowed;
    }
    if (!left && !right) return false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        int changes = 0, last = 0, first = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double step = corners[(i + 1) % n][axis] - corners[i][axis];
            if (step == 0) continue;
            const int direction = step > 0 ? 1 : -1;
            if (last == 0) first = direction;
            changes += last != 0 && direction != last ? 1 : 0;
            last = direction;
        }
        changes += last != first ? 1 : 0;
        if (changes > 2) return false;
    }
    return true;
}

/// Whether a polygon has more than the area that rounding may give to one that has none.
bool has_area(std::span<const PlanePosition> corners, double twice_area,
              const PlanePosition& rounding) {
    PlanePosition around{0, 0};  // the length along each axis
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            around[axis] += std::abs(corners[(i + 1) % corners.size()][axis] - corners[i][axis]);
    }
    return std::abs(twice_area) > 4 * (rounding[0] * around[1] + rounding[1] * around[0]);
}

/// Whether rounding may have bent a polygon, so that it is no longer convex.
bool is_bent(const RoundedParts& parts, std::size_t piece,
             bool (*is_bent_too)(std::span<const Position> corners)) {
    const auto nodes = parts.pieces.polygons[piece];
    const auto& [face, cells, sides, is_on_cutter, of] = parts.pieces[piece];
    const bool is_wall = parts.surface_of(piece, kCutFace) == kWall;
    if (nodes.size() <= 3 || parts.is_whole_face(piece) || (is_wall && !is_on_cutter)) return false;
    const auto corners = transformed(nodes, [&](NodeId node) { return parts.at(node); });
    const Position normal = polygon_normal(corners);
    if (is_bent_too != nullptr && is_bent_too(corners)) return true;
    // what lay on one of the model's surfaces must be convex in plan, the rest as it is seen best
    const bool lay_on_surface = face >= 0 && !is_on_cutter && normal[2] != 0;
    const View seen = lay_on_surface ? View({0, 0, normal[2]}) : View(normal);
    const std::vector<PlanePosition> flat = transformed(corners, seen);
    const PlanePosition rounding = seen.rounding(corners);
    // of what has no area it is not sure how it is seen best
    const bool is_sure = lay_on_surface || is_wall || has_area(flat, normal[seen.axis()], rounding);
    return !is_sure || !is_nearly_convex(flat, rounding);
}

/// Whether triangles about a middle would include one of what may be a wall that has no extent in
/// plan.
bool lacks_extent(const RoundedParts& parts, std::size_t piece, std::span<const NodeId> nodes,
                  const Position& middle) {
    if (!parts.may_be_wall(piece)) return false;
    const auto is_below = [&](NodeId node) {
        return parts.at(node)[0] == middle[0] && parts.at(node)[1] == middle[1];
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_below(nodes[i]) && is_below(nodes[(i + 1) % nodes.size()])) return true;
    }
    return false;
}

/// A new node in the middle of some nodes of a piece.
NodeId add_middle(RoundedParts& parts, std::size_t piece, std::span<const NodeId> nodes) {
    const Position first = parts.at(nodes[0]);
    Position middle = first;
    for (const NodeId node : nodes) {
        for (std::size_t k = 0; k < 3; ++k)
            middle[k] += (parts.at(node)[k] - first[k]) / static_cast<double>(nodes.size());
    }
    const bool is_base = parts.surface_of(piece, kCutFace) == kBase;
    return parts.add_node(middle, is_base ? Freedom::kLevel : Freedom::kAny);
}

/// Whether the middle of a polygon sees all of its edges from their left, but for rounding.
bool middle_sees_all(const arrangement::Loop& loop, const PlanePosition& rounding) {
    PlanePosition middle{0, 0};
    for (const arrangement::LoopCorner& corner : loop) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            middle[axis] += (corner.at[axis] - loop[0].at[axis]) / static_cast<double>(loop.size());
    }
    for (std::size_t axis = 0; axis < 2; ++axis)
        middle[axis] += loop[0].at[axis];
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const PlanePosition &a = loop[i].at, &b = loop[(i + 1) % loop.size()].at;
        if (twice_area(a, b, middle) < -arrangement::slack(a, b, middle, rounding)) return false;
    }
    return true;
}

/// A piece in polygons whose middles see all of their edges: itself, or convex parts. Between two
/// parts there is a node of their own, as about a middle.
std::vector<std::vector<NodeId>> parts_with_middles(RoundedParts& parts, std::size_t piece) {
    const auto outline = parts.pieces.polygons[piece];
    const std::vector<NodeId> nodes(outline.begin(), outline.end());
    const auto corners = transformed(nodes, [&](NodeId node) { return parts.at(node); });
    const View seen(polygon_normal(corners));
    const PlanePosition rounding = seen.rounding(corners);
    arrangement::Loop loop;
    std::vector<std::array<NodeId, 2>> edges;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        loop.push_back({nodes[i], seen(corners[i])});
        const NodeId next = nodes[(i + 1) % nodes.size()];
        edges.push_back(unordered(nodes[i], next));
    }
    if (middle_sees_all(loop, rounding)) return {nodes};
    arrangement::Polygons convex;  // a loop that crosses itself, but for rounding, has some, too
    arrangement::divide_convex({&loop, 1}, rounding, {}, convex);
    std::sort(edges.begin(), edges.end());
    std::map<std::array<NodeId, 2>, NodeId> between;
    std::vector<std::vector<NodeId>> polygons(convex.size());
    for (std::size_t k = 0; k < convex.size(); ++k) {
        const auto polygon = convex[k];
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const std::array ends{polygon[i], polygon[(i + 1) % polygon.size()]};
            polygons[k].push_back(ends[0]);
            const auto edge = unordered(ends[0], ends[1]);
            if (std::binary_search(edges.begin(), edges.end(), edge)) continue;
            const auto [at, is_new] = between.try_emplace(edge, NodeId{});
            if (is_new) at->second = add_middle(parts, piece, ends);
            polygons[k].push_back(at->second);
        }
    }
    return polygons;
}

}  // namespace

void triangulate_nonplanar(RoundedParts& parts, std::span<const std::uint8_t> is_doubled,
                           bool (*is_bent_too)(std::span<const Position> corners)) {
    assert(is_doubled.size() == parts.pieces.size());
    // a node that is added moves no other
    std::vector<std::uint8_t> is_whole(parts.pieces.size());
    parallel_ranges(
        parts.pieces.size(), 1 << 12, parts.execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                is_whole[p] =
                    is_doubled[p] == 0 && !is_bent(parts, p, is_bent_too) && !parts.is_upright(p)
                        ? 1
                        : 0;
            }
        },
        0.05);
    if (std::ranges::count(is_whole, 0) == 0) return;
    CutPieces divided;
    for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
        const std::size_t first = p;
        while (p < is_whole.size() && is_whole[p] != 0)
            ++p;
        divided.add(parts.pieces, first, p);
        if (p == is_whole.size()) break;
        for (const std::vector<NodeId>& nodes : parts_with_middles(parts, p)) {
            const NodeId center = add_middle(parts, p, nodes);
            // each try moves it aside to a new position, and only those in plan of edges will not
            // do
            for (std::size_t tries = 0; lacks_extent(parts, p, nodes, parts.at(center)); ++tries) {
                if (tries > nodes.size())
                    throw InternalError(
                        "a node in the middle of a wall lies above none of its edges",
                        parts.at(center));
                parts.moving(center) =
                    free_position_beside(parts.at(center), Freedom::kLevel, parts.taken);
            }
            for (std::size_t i = 0; i < nodes.size(); ++i)
                divided.add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], center},
                            parts.pieces[p]);
        }
    }
    parts.pieces = std::move(divided);
}

void drop_empty(RoundedParts& parts) {
    std::vector<std::int32_t> number(parts.half_cells.size(), -1);
    for (const CutPiece& piece : parts.pieces.origins) {
        for (const std::int32_t part : piece.parts) {
            if (part >= 0) number[index(part)] = 0;
        }
    }
    std::vector<HalfCell> remaining;
    for (std::size_t part = 0; part < number.size(); ++part) {
        if (number[part] < 0) continue;
        number[part] = static_cast<std::int32_t>(remaining.size());
        remaining.push_back(parts.half_cells[part]);
    }
    parts.half_cells = std::move(remaining);
    for (CutPiece& piece : parts.pieces.origins) {
        for (std::int32_t& part : piece.parts) {
            if (part >= 0) part = number[index(part)];
        }
    }
}

void round_parts(RoundedParts&& parts, const std::array<bool, 2>& touches) {
    assert(parts.are_closed());
    // First what moves many nodes at once or takes parts away, so that later passes have
    // less to do. Nodes are one before those that are left move: each moves for good to a position
    // that no other has. Extents are given by moves, too, and may bend polygons: these are divided
    // when all nodes stay where they are. Equal polygons are merged before, so that none is divided
    // twice.
    drop_hollow(parts);  // of a cell that lies flat on the cutter
    level_base(parts);
    join_coincident(parts, touches, false);
    separate_coincident_nodes(parts);
    widen_flat_parts(parts);
    triangulate_nonplanar(parts, merge_coincident_faces(parts));
    drop_empty(parts);
    assert(parts.are_closed() && parts.are_apart());
}

}  // namespace realmodel::cutting
