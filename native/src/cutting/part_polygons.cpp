// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons of rounded parts that lie on each other, or are no longer convex.
#include <algorithm>
#include <cmath>

#include "cutting/distinct.hpp"
#include "cutting/part_rounding.hpp"

namespace realmodel::cutting {

/// Where two polygons of a half are the same and face each other from outside of it, nothing is
/// between them: they become one between their parts, or none in one part. Where they face the same
/// way, for parts that overlap, one of them is to be divided.
void PartRounding::glue_doubled() {
    std::vector<std::pair<std::vector<NodeId>, std::size_t>> order;  // sorted nodes, piece
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const auto nodes = pieces_.polygons[p];
        if (!std::all_of(nodes.begin(), nodes.end(),
                         [this](NodeId node) { return is_near_[index(node)] != 0; }))
            continue;
        auto& key = order.emplace_back(std::vector<NodeId>(nodes.begin(), nodes.end()), p).first;
        std::sort(key.begin(), key.end());
    }
    std::sort(order.begin(), order.end());
    /// Which way round a polygon goes from its least node to its second least
    const auto turned = [this](std::size_t p) {
        const auto nodes = pieces_.polygons[p];
        const auto least =
            static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
        const std::size_t n = nodes.size();
        return nodes[(least + 1) % n] < nodes[(least + n - 1) % n] ? 1 : -1;
    };
    Pieces glued;
    PieceParts glued_parts;
    std::vector<std::uint8_t> glued_doubled;
    is_doubled_.assign(pieces_.size(), 0);
    bool any = false;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && order[end].first == order[begin].first)
            ++end;
        if (end - begin < 2) continue;
        struct Outer {
            std::size_t piece, which;
            int turned;
        };
        for (const std::int8_t half : {kBelow, kAbove}) {
            std::vector<Outer> outers;
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t p = order[i].second;
                const auto& sides = pieces_.sides[p];
                for (std::size_t k = 0; k < 2; ++k) {
                    if (parts_[p][k] < 0 || sides[k] != half) continue;
                    if (parts_[p][1 - k] >= 0 && sides[1 - k] == half) continue;
                    const Outer own{p, k, k == 0 ? turned(p) : -turned(p)};
                    const auto against =
                        std::find_if(outers.begin(), outers.end(),
                                     [&](const Outer& o) { return o.turned == -own.turned; });
                    if (against == outers.end()) {
                        if (!outers.empty()) is_doubled_[p] = 1;
                        outers.push_back(own);
                        continue;
                    }
                    any = true;
                    const std::array both{*against, own};
                    const std::array part{parts_[both[0].piece][both[0].which],
                                          parts_[both[1].piece][both[1].which]};
                    if (part[0] != part[1]) {
                        const auto nodes = pieces_.polygons[both[0].piece];
                        std::vector<NodeId> loop(nodes.begin(), nodes.end());
                        if (both[0].which == 1) std::reverse(loop.begin(), loop.end());
                        glued.polygons.add(loop);
                        glued.face.push_back(-1);
                        glued.cells.push_back(
                            {half_cells_[index(part[0])].cell, half_cells_[index(part[1])].cell});
                        glued.sides.push_back({half, half});
                        glued.level.push_back(0);
                        glued_parts.push_back(part);
                        glued_doubled.push_back(0);
                    }
                    for (const Outer& o : both)
                        parts_[o.piece][o.which] = -1;
                    outers.erase(against);
                }
            }
        }
    }
    if (!any) return;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        if (parts_[p][0] < 0 && parts_[p][1] < 0) continue;
        glued.polygons.add(pieces_.polygons[p]);
        glued.face.push_back(pieces_.face[p]);
        glued.cells.push_back(pieces_.cells[p]);
        glued.sides.push_back(pieces_.sides[p]);
        glued.level.push_back(pieces_.level[p]);
        glued_parts.push_back(parts_[p]);
        glued_doubled.push_back(is_doubled_[p]);
    }
    is_doubled_ = std::move(glued_doubled);
    pieces_ = std::move(glued);
    parts_ = std::move(glued_parts);
    find_pieces_of_parts();
    drop_hollow();
}

/// Takes away parts of which two polygons are left that lie on each other: what is beyond the one
/// meets what is beyond the other.
void PartRounding::drop_hollow() {
    bool any = false;
    for (std::size_t part = 0; part < half_cells_.size(); ++part) {
        if (first_[part + 1] - first_[part] != 2) continue;
        const auto at = static_cast<std::size_t>(first_[part]);
        const std::array both{index(pieces_of_[at]), index(pieces_of_[at + 1])};
        const auto number = static_cast<std::int32_t>(part);
        const bool has_both = both[0] != both[1] && std::ranges::all_of(both, [&](std::size_t p) {
                                  return std::ranges::count(parts_[p], number) == 1;
                              });
        if (!has_both) continue;
        any = true;
        std::array<std::size_t, 2> own{};
        std::array<std::int32_t, 2> beyond{};  // the parts of this half there, or none
        for (std::size_t k = 0; k < 2; ++k) {
            own[k] = parts_[both[k]][0] == number ? 0 : 1;
            const auto& sides = pieces_.sides[both[k]];
            beyond[k] = sides[0] == sides[1] ? parts_[both[k]][1 - own[k]] : -1;
        }
        const std::size_t stays = beyond[0] < 0 ? 0 : 1, goes = 1 - stays;
        const std::int32_t next = beyond[goes] == beyond[stays] ? -1 : beyond[goes];
        parts_[both[stays]][own[stays]] = next;
        parts_[both[goes]][own[goes]] = -1;
        if (next >= 0) {
            pieces_.cells[both[stays]][own[stays]] = half_cells_[index(next)].cell;
            parts_[both[goes]] = {-1, -1};
        } else if (beyond[stays] >= 0) {
            parts_[both[stays]] = parts_[both[goes]] = {-1, -1};
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
        const double turn = ux * vy - uy * vx;
        const double allowed = rounding[0] * (std::abs(uy) + std::abs(vy)) +
                               rounding[1] * (std::abs(ux) + std::abs(vx));
        left = left && turn >= -allowed;
        right = right && turn <= allowed;
    }
    if (!left && !right) return false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        int changes = 0, last = 0, first = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double step = corners[(i + 1) % n][axis] - corners[i][axis];
            if (step == 0) continue;
            const int way = step > 0 ? 1 : -1;
            if (last == 0) first = way;
            changes += last != 0 && way != last ? 1 : 0;
            last = way;
        }
        changes += last != first ? 1 : 0;
        if (changes > 2) return false;
    }
    return true;
}

/// Whether a polygon has more than the area that rounding may give to one that has none.
bool has_area(std::span<const PlanePosition> corners, double twice_area,
              const PlanePosition& rounding) {
    PlanePosition around{0, 0};  // the way along each axis
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            around[axis] += std::abs(corners[(i + 1) % corners.size()][axis] - corners[i][axis]);
    }
    return std::abs(twice_area) > 4 * (rounding[0] * around[1] + rounding[1] * around[0]);
}

}  // namespace

/// Divides polygons that rounding has bent, and those that are there already.
void PartRounding::divide_bent() {
    Pieces divided;
    PieceParts parts;
    std::vector<Position> corners;
    std::vector<PlanePosition> flat;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const auto nodes = pieces_.polygons[p];
        const auto add = [&](std::span<const NodeId> polygon) {
            divided.polygons.add(polygon);
            divided.face.push_back(pieces_.face[p]);
            divided.cells.push_back(pieces_.cells[p]);
            divided.sides.push_back(pieces_.sides[p]);
            divided.level.push_back(pieces_.level[p]);
            parts.push_back(parts_[p]);
        };
        const std::int32_t face = pieces_.face[p];
        const bool is_made = face < 0 || !std::ranges::equal(nodes, model_.face(index(face)));
        const bool may_be_bent =
            nodes.size() > 3 && is_made && (!is_wall(p) || pieces_.level[p] != 0);
        if (!may_be_bent && is_doubled_[p] == 0) {
            add(nodes);
            continue;
        }
        corners.clear();
        for (const NodeId node : nodes)
            corners.push_back(at(node));
        const Position normal = polygon_normal(corners);
        // what lay on one of the model's surfaces must be convex in plan, the rest as it is seen
        // best
        const bool lay_on_surface = face >= 0 && pieces_.level[p] == 0 && normal[2] != 0;
        const View seen = lay_on_surface ? View({0, 0, normal[2]}) : View(normal);
        flat.clear();
        for (const Position& corner : corners)
            flat.push_back(seen(corner));
        const PlanePosition rounding = seen.rounding(corners);
        // of what has no area it is not sure how it is seen best
        const bool is_sure =
            lay_on_surface || is_wall(p) || has_area(flat, normal[seen.axis()], rounding);
        if (is_doubled_[p] == 0 && is_sure && is_nearly_convex(flat, rounding)) {
            add(nodes);
            continue;
        }
        // in triangles about a node of its own: an edge between two others may be one already
        Position middle = corners[0];
        for (const Position& corner : corners) {
            for (std::size_t k = 0; k < 3; ++k)
                middle[k] += (corner[k] - corners[0][k]) / static_cast<double>(corners.size());
        }
        if (!taken_.insert(middle).second) {
            const bool on_base = face >= 0 && model_.face_surface[index(face)] == strata::kBase;
            middle =
                free_position_beside(middle, on_base ? Freedom::kLevel : Freedom::kAny, taken_);
        }
        new_positions_.push_back(middle);
        const auto centre = static_cast<NodeId>(vertices_.size() + new_positions_.size()) - 1;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], centre});
    }
    pieces_ = std::move(divided);
    parts_ = std::move(parts);
}

}  // namespace realmodel::cutting
