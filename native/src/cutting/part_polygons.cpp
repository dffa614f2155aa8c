// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons of rounded parts that lie on each other, or are no longer convex.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "base/parallel.hpp"
#include "cutting/part_rounding.hpp"

namespace realmodel::cutting {

/// A piece, and the one of its sides that is within a half where the other side is not.
struct PartRounding::Outer {
    std::size_t piece, which;
    int winding;
};

/// Which way round a polygon goes from its least node to its second least.
int PartRounding::winding(std::size_t piece) const {
    const auto nodes = pieces_.polygons[piece];
    const auto least =
        static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
    const std::size_t n = nodes.size();
    return nodes[(least + 1) % n] < nodes[(least + n - 1) % n] ? 1 : -1;
}

/// Of equal polygons of one half: those that face each other from outside of it become one between
/// their parts, which is added to `glued`, or none in one part. Whether there were any.
bool PartRounding::glue(std::span<const std::size_t> equal, std::int8_t half, Pieces& glued) {
    bool any = false;
    std::vector<Outer> outers;
    for (const std::size_t p : equal) {
        const auto& sides = pieces_[p].sides;
        for (std::size_t k = 0; k < 2; ++k) {
            if (pieces_[p].parts[k] < 0 || sides[k] != half) continue;
            if (pieces_[p].parts[1 - k] >= 0 && sides[1 - k] == half) continue;
            const Outer own{p, k, k == 0 ? winding(p) : -winding(p)};
            const auto against = std::ranges::find(outers, -own.winding, &Outer::winding);
            if (against == outers.end()) {
                if (!outers.empty()) is_doubled_[p] = 1;
                outers.push_back(own);
                continue;
            }
            any = true;
            const std::array parts{pieces_[against->piece].parts[against->which],
                                   pieces_[p].parts[k]};
            if (parts[0] != parts[1]) {
                const Piece between{
                    -1,
                    {half_cells_[index(parts[0])].cell, half_cells_[index(parts[1])].cell},
                    {half, half},
                    false,
                    parts};
                const auto nodes = pieces_.polygons[against->piece];
                if (against->which == 1) {
                    glued.add_reversed(nodes, between);
                } else {
                    glued.add(nodes, between);
                }
            }
            pieces_[against->piece].parts[against->which] = pieces_[p].parts[k] = -1;
            outers.erase(against);
        }
    }
    return any;
}

/// Where two polygons of a half are the same and face each other from outside of it, nothing is
/// between them: they are glued. Where they face the same way, for parts that overlap, one of them
/// is to be divided.
void PartRounding::glue_doubled() {
    const auto order = find_doubled();
    Pieces glued;
    is_doubled_.assign(pieces_.size(), 0);
    bool any = false;
    std::vector<std::size_t> equal;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        equal.clear();
        for (; end < order.size() && order[end].first == order[begin].first; ++end)
            equal.push_back(order[end].second);
        if (equal.size() < 2) continue;
        for (const std::int8_t half : {kBelow, kAbove})
            any = glue(equal, half, glued) || any;
    }
    if (!any) return;
    std::vector<std::uint8_t> glued_doubled(glued.size(), 0);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        if (pieces_[p].parts[0] < 0 && pieces_[p].parts[1] < 0) continue;
        glued.add(pieces_.polygons[p], pieces_[p]);
        glued_doubled.push_back(is_doubled_[p]);
    }
    is_doubled_ = std::move(glued_doubled);
    pieces_ = std::move(glued);
    find_pieces_of_parts();
    drop_hollow();
}

/// Takes away parts of which two polygons are left that lie on each other: what is beyond the one
/// meets what is beyond the other.
void PartRounding::drop_hollow() {
    bool any = false;
    for (std::size_t part = 0; part < half_cells_.size(); ++part) {
        const auto own_pieces = pieces_of_[part];
        if (own_pieces.size() != 2) continue;
        const std::array both{index(own_pieces[0]), index(own_pieces[1])};
        const auto number = static_cast<std::int32_t>(part);
        const bool has_both = both[0] != both[1] && std::ranges::all_of(both, [&](std::size_t p) {
                                  return std::ranges::count(pieces_[p].parts, number) == 1;
                              });
        if (!has_both) continue;
        any = true;
        std::array<std::size_t, 2> own{};
        std::array<std::int32_t, 2> beyond{};  // the parts of this half there, or none
        for (std::size_t k = 0; k < 2; ++k) {
            own[k] = pieces_[both[k]].parts[0] == number ? 0 : 1;
            const auto& sides = pieces_[both[k]].sides;
            beyond[k] = sides[0] == sides[1] ? pieces_[both[k]].parts[1 - own[k]] : -1;
        }
        const std::size_t stays = beyond[0] < 0 ? 0 : 1, goes = 1 - stays;
        const std::int32_t next = beyond[goes] == beyond[stays] ? -1 : beyond[goes];
        pieces_[both[stays]].parts[own[stays]] = next;
        pieces_[both[goes]].parts[own[goes]] = -1;
        if (next >= 0) {
            pieces_[both[stays]].cells[own[stays]] = half_cells_[index(next)].cell;
            pieces_[both[goes]].parts = {-1, -1};
        } else if (beyond[stays] >= 0) {
            pieces_[both[stays]].parts = pieces_[both[goes]].parts = {-1, -1};
        }
    }
    if (any) find_pieces_of_parts();
}

namespace {

/// Whether a polygon turns one way and rises and falls once on both axes, but for rounding.
bool is_nearly_convex(std::span<const PlanePosition> corners, const PlanePosition& rounding) {
    bool left = true, right = true;
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
        const PlanePosition &a = corners[i], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
        const double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1];
        const double cross = ux * vy - uy * vx;
        const double allowed = rounding[0] * (std::abs(uy) + std::abs(vy)) +
                               rounding[1] * (std::abs(ux) + std::abs(vx));
        left = left && cross >= -allowed;
        right = right && cross <= allowed;
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

/// Whether corners lie in the plane that fits them, but for the rounding of their coordinates.
bool is_flat(std::span<const Position> corners) {
    constexpr double kUnits = 8;  // in the last place, by which coordinates may be off
    const Position normal = polygon_normal(corners);
    double allowed = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double largest = 0;
        for (const Position& p : corners)
            largest = std::max(largest, std::abs(p[axis]));
        allowed += kUnits * std::abs(normal[axis]) * (std::nextafter(largest, HUGE_VAL) - largest);
    }
    return std::ranges::all_of(corners, [&](const Position& p) {
        return std::abs(dot(normal, minus(p, corners[0]))) <= allowed;
    });
}

}  // namespace

/// Whether rounding may have bent a polygon, so that it is no longer convex; of joined models,
/// where nodes of several become one, also whether it is no longer flat.
bool PartRounding::is_bent(std::size_t piece) const {
    const auto nodes = pieces_.polygons[piece];
    const auto& [face, cells, sides, is_level, parts] = pieces_[piece];
    if (nodes.size() <= 3 || is_whole_face(piece) || (is_wall(piece) && !is_level)) return false;
    std::vector<Position> corners;
    for (const NodeId node : nodes)
        corners.push_back(at(node));
    const Position normal = polygon_normal(corners);
    if (joins_models_ && !is_flat(corners)) return true;
    // what lay on one of the model's surfaces must be convex in plan, the rest as it is seen best
    const bool lay_on_surface = face >= 0 && !is_level && normal[2] != 0;
    const View seen = lay_on_surface ? View({0, 0, normal[2]}) : View(normal);
    std::vector<PlanePosition> flat;
    for (const Position& corner : corners)
        flat.push_back(seen(corner));
    const PlanePosition rounding = seen.rounding(corners);
    // of what has no area it is not sure how it is seen best
    const bool is_sure =
        lay_on_surface || is_wall(piece) || has_area(flat, normal[seen.axis()], rounding);
    return !is_sure || !is_nearly_convex(flat, rounding);
}

/// Whether triangles about a middle would include one of what may be a wall that has no extent in
/// plan.
bool PartRounding::lacks_extent(std::size_t piece, const Position& middle) const {
    if (!joins_models_ || (pieces_[piece].face >= 0 && !is_wall(piece))) return false;
    const auto nodes = pieces_.polygons[piece];
    const auto is_below = [&](NodeId node) {
        return at(node)[0] == middle[0] && at(node)[1] == middle[1];
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_below(nodes[i]) && is_below(nodes[(i + 1) % nodes.size()])) return true;
    }
    return false;
}

/// A new node in the middle of a polygon, or beside it where there is one already.
NodeId PartRounding::add_middle(std::size_t piece) {
    take_all_vertices();
    const auto nodes = pieces_.polygons[piece];
    const Position first = at(nodes[0]);
    Position middle = first;
    for (const NodeId node : nodes) {
        for (std::size_t k = 0; k < 3; ++k)
            middle[k] += (at(node)[k] - first[k]) / static_cast<double>(nodes.size());
    }
    if (!taken_.insert(middle)) {
        const std::int32_t face = pieces_[piece].face;
        const bool on_base = face >= 0 && model_.face_surface[index(face)] == kBase;
        middle = free_position_beside(middle, on_base ? Freedom::kLevel : Freedom::kAny, taken_);
    }
    while (lacks_extent(piece, middle))
        middle = free_position_beside(middle, Freedom::kLevel, taken_);
    new_positions_.push_back(middle);
    return checked_number(vertices_.size() + new_positions_.size(), "vertices and new nodes") - 1;
}

namespace {

/// A polygon that has an edge, and which way it goes along it; between two parts, -1 none.
struct EdgeOfPiece {
    std::array<NodeId, 2> edge;
    std::size_t piece;
    int direction;
    std::array<std::int32_t, 2> parts;

    bool is_of(std::int32_t part) const { return parts[0] == part || parts[1] == part; }
    std::int32_t beyond(std::int32_t part) const { return parts[parts[0] == part ? 1 : 0]; }
    int direction_of(std::int32_t part) const { return parts[0] == part ? direction : -direction; }
};

/// Of all that have an edge the fewest, as numbers, that lead from a part which has it more than
/// twice through other parts back to it: each of these has two of them, which turn against each
/// other. None where no part has it more than twice, or there is no such way.
std::vector<std::size_t> way_back(std::span<const EdgeOfPiece> uses) {
    std::map<std::int32_t, int> count;
    for (const EdgeOfPiece& use : uses) {
        for (const std::int32_t part : use.parts)
            ++count[part];
    }
    std::vector<std::size_t> best;
    for (const auto& [part, times] : count) {
        if (part < 0 || times <= 2) continue;
        for (std::size_t start = 0; start < uses.size(); ++start) {
            if (!uses[start].is_of(part)) continue;
            constexpr std::size_t kNot = SIZE_MAX;
            std::vector<std::size_t> before(uses.size(), kNot);
            before[start] = start;
            struct At {
                std::size_t use;
                std::int32_t entered;
            };
            std::vector<At> open{{start, uses[start].beyond(part)}};
            std::size_t last = kNot;
            for (std::size_t i = 0; i < open.size() && last == kNot; ++i) {
                const auto [use, entered] = open[i];
                for (std::size_t next = 0; next < uses.size() && last == kNot; ++next) {
                    if (before[next] != kNot || !uses[next].is_of(entered) ||
                        uses[next].direction_of(entered) != -uses[use].direction_of(entered))
                        continue;
                    const std::int32_t beyond = uses[next].beyond(entered);
                    const bool is_back = beyond == part;
                    if (is_back && uses[next].direction_of(part) != -uses[start].direction_of(part))
                        continue;
                    before[next] = use;
                    if (is_back) last = next;
                    open.push_back({next, beyond});
                }
            }
            if (last == kNot) continue;
            std::vector<std::size_t> way{last};
            while (way.back() != start)
                way.push_back(before[way.back()]);
            if (best.empty() || way.size() < best.size()) best = std::move(way);
        }
    }
    return best;
}

}  // namespace

/// The edges near the cutter that some part has more than twice, in order.
std::vector<std::array<NodeId, 2>> PartRounding::touching_edges() const {
    std::vector<std::int32_t> parts(half_cells_.size());
    std::iota(parts.begin(), parts.end(), 0);
    std::vector<std::vector<std::uint64_t>> of_parts(parts.size());
    each_of_parts(parts, [&](std::size_t part, Memory& memory) {
        auto& uses = memory.uses;
        uses.clear();
        for (const std::int32_t p : pieces_of_[part]) {
            const auto nodes = pieces_.polygons[index(p)];
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const NodeId a = nodes[i], b = nodes[i + 1 < nodes.size() ? i + 1 : 0];
                if (is_near_[index(a)] != 0 && is_near_[index(b)] != 0)
                    uses.push_back(number_of(unordered(a, b)));
            }
        }
        std::sort(uses.begin(), uses.end());
        for (std::size_t i = 2; i < uses.size(); ++i) {
            if (uses[i] == uses[i - 2]) of_parts[part].push_back(uses[i]);
        }
    });
    std::vector<std::array<NodeId, 2>> found;
    for (const auto& own : of_parts)
        std::ranges::transform(own, std::back_inserter(found), edge_of);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

/// Where parts use an edge more than twice, polygons that lead round other parts there get a node
/// of their own on it.
void PartRounding::set_touching_apart() {
    const auto touching = touching_edges();
    if (touching.empty()) return;
    std::vector<EdgeOfPiece> uses;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const auto nodes = pieces_.polygons[p];
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const NodeId a = nodes[i], b = nodes[(i + 1) % nodes.size()];
            if (std::ranges::binary_search(touching, unordered(a, b)))
                uses.push_back({unordered(a, b), p, a < b ? 1 : -1, pieces_[p].parts});
        }
    }
    std::ranges::stable_sort(uses, {}, &EdgeOfPiece::edge);
    std::map<std::size_t, std::vector<std::pair<std::array<NodeId, 2>, NodeId>>> nodes_on;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        while (end < uses.size() && uses[end].edge == uses[begin].edge)
            ++end;
        if (end - begin <= 2) continue;
        std::vector<EdgeOfPiece> own(uses.begin() + static_cast<std::ptrdiff_t>(begin),
                                     uses.begin() + static_cast<std::ptrdiff_t>(end));
        while (true) {
            std::vector<std::size_t> way = way_back(own);
            if (way.empty()) break;
            std::ranges::sort(way, std::greater<>{});  // each is erased without moving the next
            const NodeId middle = add_between(uses[begin].edge);
            for (const std::size_t use : way)
                nodes_on[own[use].piece].push_back({uses[begin].edge, middle});
            for (const std::size_t use : way)
                own.erase(own.begin() + static_cast<std::ptrdiff_t>(use));
        }
    }
    if (nodes_on.empty()) return;
    Pieces apart;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        std::vector<NodeId> loop;
        const auto nodes = pieces_.polygons[p];
        const auto found = nodes_on.find(p);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            loop.push_back(nodes[i]);
            if (found == nodes_on.end()) continue;
            const auto edge = unordered(nodes[i], nodes[(i + 1) % nodes.size()]);
            for (const auto& [at, middle] : found->second) {
                if (at == edge) loop.push_back(middle);
            }
        }
        apart.add(loop, pieces_[p]);
    }
    pieces_ = std::move(apart);
    find_pieces_of_parts();
}

/// A new node between the ends of an edge, where no other is.
NodeId PartRounding::add_between(const std::array<NodeId, 2>& edge) {
    take_all_vertices();
    Position middle;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] = at(edge[0])[k] + (at(edge[1])[k] - at(edge[0])[k]) / 2;
    if (!taken_.insert(middle)) middle = free_position_beside(middle, freedom_of(edge), taken_);
    new_positions_.push_back(middle);
    return checked_number(vertices_.size() + new_positions_.size(), "vertices and new nodes") - 1;
}

/// Divides polygons that rounding has bent, and those that are there already, in triangles about a
/// node of their own: an edge between two others may be one already.
void PartRounding::divide_bent() {
    // a node that is added moves no other
    std::vector<std::uint8_t> is_whole(pieces_.size());
    parallel_ranges(
        pieces_.size(), 1 << 12, execution_,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p)
                is_whole[p] =
                    is_doubled_[p] == 0 && !is_bent(p) && !(joins_models_ && is_upright(p)) ? 1 : 0;
        },
        0.05);
    if (std::ranges::count(is_whole, 0) == 0) return;
    Pieces divided;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const auto nodes = pieces_.polygons[p];
        if (is_whole[p] != 0) {
            divided.add(nodes, pieces_[p]);
            continue;
        }
        const NodeId center = add_middle(p);
        for (std::size_t i = 0; i < nodes.size(); ++i)
            divided.add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], center}, pieces_[p]);
    }
    pieces_ = std::move(divided);
}

}  // namespace realmodel::cutting
