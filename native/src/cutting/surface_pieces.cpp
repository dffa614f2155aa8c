// SPDX-License-Identifier: GPL-3.0-or-later
// The polygons that both halves are made of, and their parts.
#include <algorithm>
#include <cmath>

#include "distinct.hpp"
#include "plane_sides.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/parallel_chunks.hpp"
#include "surface_cut.hpp"
#include "triangulate.hpp"

namespace realmodel::cutting {

/// The wall of a hollow that the surface cuts out of a cell bounds the part around it.
void SurfaceCut::attach_hollows() {
    struct Shell {
        std::int32_t root;
        double volume = 0;
        Box box;
    };
    std::map<std::int32_t, std::map<std::int32_t, Shell>> shells;  // by cell and set
    std::vector<Position> origin(is_cut_.size());
    std::vector<std::uint8_t> has_origin(is_cut_.size(), 0);
    const auto take = [&](std::int32_t cell, std::int32_t own, const auto& loops, bool turned) {
        if (cell < 0 || is_cut_[index(cell)] == 0) return;
        const std::int32_t root = sets_->find(own);
        Shell& shell = shells[cell].try_emplace(root, Shell{root, 0, {}}).first->second;
        if (has_origin[index(cell)] == 0) {
            has_origin[index(cell)] = 1;
            origin[index(cell)] = position(loops[0][0]);
        }
        for (const auto& loop : loops) {
            const Position first = position(loop[0]);
            for (std::size_t i = 0; i < loop.size(); ++i) {
                shell.box.include(position(loop[i]));
                if (i < 2) continue;
                const double part = sixfold_volume(origin[index(cell)], first,
                                                   position(loop[i - 1]), position(loop[i]));
                shell.volume += turned ? -part : part;
            }
        }
    };
    for (std::size_t r = 0; r < regions().size(); ++r) {
        const auto item = static_cast<std::int32_t>(r);
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t cell =
                is_cap_region(r) ? cap_cell_[r]
                                 : model_.cell(index(face_of_[index(regions()[r].triangle)]), k);
            take(cell, static_cast<std::int32_t>(slot(item, k)), loops_[r], k == 1);
        }
    }
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        if (active_[f] != 0) continue;
        const auto item = static_cast<std::int32_t>(item_of_face(f));
        for (std::size_t k = 0; k < 2; ++k) {
            take(model_.cell(f, k), static_cast<std::int32_t>(slot(item, k)),
                 std::array{model_.face(f)}, k == 1);
        }
    }
    for (const auto& [cell, of_cell] : shells) {
        for (const auto& [root, hollow] : of_cell) {
            if (hollow.volume >= 0) continue;
            const Shell* around = nullptr;
            for (const auto& [other, shell] : of_cell) {
                if (shell.volume <= -hollow.volume * (1 + 1e-9)) continue;
                const bool better =
                    around == nullptr ||
                    std::pair(!shell.box.contains(hollow.box), shell.volume) <
                        std::pair(!around->box.contains(hollow.box), around->volume);
                if (better) around = &shell;
            }
            if (around != nullptr) sets_->join(around->root, root);
        }
    }
}

/// Adds the polygons of a face's or the surface's connected regions; `region` is one of them.
void SurfaceCut::add_piece(std::span<const std::vector<NodeId>> loops, const Position& normal,
                           std::int32_t face, std::int32_t region) {
    Polygons polygons;
    const bool is_wall = face >= 0 && model_.face_surface[index(face)] == strata::kWall;
    const View view(normal);
    std::vector<Loop> corners;
    std::vector<Position> positions;
    for (const auto& loop : loops) {
        Loop& own = corners.emplace_back();
        for (const NodeId p : loop) {
            positions.push_back(position(p));
            own.push_back({p, view(positions.back())});
        }
    }
    std::vector<NodeId> sorted = loops[0];
    std::sort(sorted.begin(), sorted.end());
    const bool simple = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
    if (is_wall && loops.size() == 1 && simple) {
        polygons.add(loops[0]);
    } else {
        divide_convex(corners, rounding_of(positions), {}, polygons);
    }
    std::array<std::int32_t, 2> cells{cap_cell_[index(region)], cap_cell_[index(region)]};
    if (face >= 0) cells = {model_.cell(index(face), 0), model_.cell(index(face), 1)};
    std::array<std::int32_t, 2> part{-1, -1};
    std::array<std::int8_t, 2> sides{kOn, kOn};
    for (std::size_t k = 0; k < 2; ++k) {
        if (cells[k] < 0) continue;
        part[k] = sets_->find(static_cast<std::int32_t>(slot(region, k)));
        sides[k] = side_[slot(region, k)];
    }
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        pieces_.polygons.add(polygons[p]);
        pieces_.face.push_back(face);
        pieces_.cells.push_back(cells);
        pieces_.sides.push_back(sides);
        pieces_.level.push_back(face < 0 || level_[index(region)] >= 0 ? 1 : 0);
        parts_.push_back(part);
    }
}

/// A face's regions, those of its triangles that no part of the surface lies between joined again.
void SurfaceCut::make_face_pieces(std::size_t face, std::span<const std::int32_t> own) {
    struct Half {
        NodeId from, to;
        std::int32_t region, next, twin;
    };
    std::vector<Half> halves;
    std::map<std::array<NodeId, 2>, std::vector<std::int32_t>> by_ends;
    for (std::size_t i = 0; i < own.size(); ++i) {
        for (const auto& loop : loops_[index(own[i])]) {
            const auto first = static_cast<std::int32_t>(halves.size());
            const auto size = static_cast<std::int32_t>(loop.size());
            for (std::int32_t k = 0; k < size; ++k) {
                by_ends[{loop[index(k)], loop[index((k + 1) % size)]}].push_back(first + k);
                halves.push_back({loop[index(k)], loop[index((k + 1) % size)],
                                  static_cast<std::int32_t>(i), first + (k + 1) % size, -1});
            }
        }
    }
    strata::DisjointParts joined(own.size());
    for (auto& [ends, users] : by_ends) {
        if (ends[0] > ends[1] || std::binary_search(barriers_.begin(), barriers_.end(), ends))
            continue;
        const auto against = by_ends.find({ends[1], ends[0]});
        if (against == by_ends.end()) continue;
        for (std::size_t i = 0; i < std::min(users.size(), against->second.size()); ++i) {
            Half &h = halves[index(users[i])], &g = halves[index(against->second[i])];
            h.twin = against->second[i];
            g.twin = users[i];
            joined.join(h.region, g.region);
        }
    }
    std::map<std::int32_t, std::vector<std::vector<NodeId>>> groups;
    std::vector<bool> done(halves.size(), false);
    for (std::size_t start = 0; start < halves.size(); ++start) {
        if (done[start] || halves[start].twin >= 0) continue;
        auto& loop = groups[joined.find(halves[start].region)].emplace_back();
        std::size_t h = start;
        do {
            done[h] = true;
            loop.push_back(halves[h].from);
            h = index(halves[h].next);
            while (halves[h].twin >= 0)
                h = index(halves[index(halves[h].twin)].next);
        } while (h != start);
    }
    std::vector<Position> corners;
    for (const NodeId v : model_.face(face))
        corners.push_back(model_.vertex(v));
    for (const auto& [group, loops] : groups)
        add_piece(loops, polygon_normal(corners), static_cast<std::int32_t>(face),
                  own[index(group)]);
}

void SurfaceCut::make_pieces() {
    for (std::size_t r = 0; r < regions().size(); ++r) {
        if (!is_cap_region(r) || (cap_cell_[r] < 0 && used_up_[r] == 0)) continue;
        for (const auto& loop : loops_[r]) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
                barriers_.push_back({std::min(a, b), std::max(a, b)});
            }
        }
    }
    std::sort(barriers_.begin(), barriers_.end());
    barriers_.erase(std::unique(barriers_.begin(), barriers_.end()), barriers_.end());
    std::vector<std::vector<std::int32_t>> of_face(model_.face_count());
    for (std::size_t r = 0; r < regions().size(); ++r) {
        if (!is_cap_region(r))
            of_face[index(face_of_[index(regions()[r].triangle)])].push_back(
                static_cast<std::int32_t>(r));
    }
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        strata::poll(progress_, f);
        if (active_[f] != 0) {
            make_face_pieces(f, of_face[f]);
            continue;
        }
        const auto item = static_cast<std::int32_t>(item_of_face(f));
        std::array<std::int32_t, 2> part{-1, -1};
        std::array<std::int8_t, 2> sides{kOn, kOn};
        for (std::size_t k = 0; k < 2; ++k) {
            if (model_.cell(f, k) < 0) continue;
            part[k] = sets_->find(static_cast<std::int32_t>(slot(item, k)));
            sides[k] = side_[slot(item, k)];
        }
        pieces_.polygons.add(model_.face(f));
        pieces_.face.push_back(static_cast<std::int32_t>(f));
        pieces_.cells.push_back({model_.cell(f, 0), model_.cell(f, 1)});
        pieces_.sides.push_back(sides);
        pieces_.level.push_back(0);
        parts_.push_back(part);
    }
    for (std::size_t r = 0; r < regions().size(); ++r) {
        if (!is_cap_region(r) || cap_cell_[r] < 0) continue;
        const auto& triangle = overlay_.corners(regions()[r].triangle);
        const std::array corners{points_.rounded(triangle[0]), points_.rounded(triangle[1]),
                                 points_.rounded(triangle[2])};
        add_piece(loops_[r], polygon_normal(corners), -1, static_cast<std::int32_t>(r));
    }
}

/// Cells of the halves in the order of the model's cells, parts of one in that of their pieces.
void SurfaceCut::number_cells() {
    struct Part {
        std::int32_t cell, root;
        std::int8_t side;
    };
    std::vector<Part> found;
    std::map<std::int32_t, std::int32_t> number;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t root = parts_[p][k];
            if (root < 0 || !number.emplace(root, 0).second) continue;
            found.push_back({pieces_.cells[p][k], root, pieces_.sides[p][k]});
        }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Part& a, const Part& b) { return a.cell < b.cell; });
    for (const Part& part : found) {
        number[part.root] = static_cast<std::int32_t>(half_cells_.size());
        half_cells_.push_back({part.cell, part.side});
    }
    for (auto& part : parts_) {
        for (std::int32_t& root : part) {
            if (root >= 0) root = number[root];
        }
    }
}

/// Gives nodes that rounded to one position, or to that of a vertex, positions of their own, and
/// parts without thickness some.
void SurfaceCut::make_distinct() {
    std::set<Position> taken;
    for (std::size_t v = 0; v < vertex_node_.size(); ++v) {
        if (vertex_node_[v] >= 0) taken.insert(model_.vertex(static_cast<NodeId>(v)));
    }
    for (Position& p : new_positions_) {
        if (!taken.insert(p).second) p = free_position_beside(p, taken);
    }
    const auto vertices = static_cast<NodeId>(model_.vertex_count());
    std::vector<Box> boxes(half_cells_.size());
    std::vector<NodeId> last(half_cells_.size(), -1);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        for (const std::int32_t cell : parts_[p]) {
            if (cell < 0 || is_cut_[index(half_cells_[index(cell)].cell)] == 0) continue;
            for (const NodeId node : pieces_.polygons[p]) {
                boxes[index(cell)].include(position(node));
                last[index(cell)] = std::max(last[index(cell)], node);
            }
        }
    }
    for (std::size_t c = 0; c < boxes.size(); ++c) {
        if (last[c] < vertices) continue;
        Position& p = new_positions_[index(last[c] - vertices)];
        bool flat = false;
        for (std::size_t k = 0; k < 3; ++k) {
            if (boxes[c].low[k] != boxes[c].high[k]) continue;
            p[k] = std::nextafter(p[k], HUGE_VAL);
            flat = true;
        }
        if (flat && !taken.insert(p).second) p = free_position_beside(p, taken);
    }
}

/// Makes sure that all parts of cells near the surface are closed. Whether some below, or above,
/// use an edge more than twice.
std::array<bool, 2> SurfaceCut::verify() const {
    struct CellEdge {
        std::int32_t cell;
        NodeId low, high;
        int direction;
        auto operator<=>(const CellEdge&) const = default;
    };
    std::vector<std::uint8_t> near(model_.cell_block.size(), 0);
    for (const std::int32_t f : active_faces_) {
        for (std::size_t k = 0; k < 2; ++k) {
            if (model_.cell(index(f), k) >= 0) near[index(model_.cell(index(f), k))] = 1;
        }
    }
    std::vector<CellEdge> uses;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const auto nodes = pieces_.polygons[p];
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t cell = parts_[p][k];
            if (cell < 0 || near[index(half_cells_[index(cell)].cell)] == 0) continue;
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const NodeId a = nodes[i], b = nodes[i + 1 < nodes.size() ? i + 1 : 0];
                uses.push_back(
                    {cell, std::min(a, b), std::max(a, b), (a < b) == (k == 0) ? 1 : -1});
            }
        }
    }
    std::sort(uses.begin(), uses.end());
    std::array<bool, 2> touches{false, false};
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        int sum = 0;
        if (begin + 2 < uses.size() && uses[begin + 2].cell == uses[begin].cell &&
            uses[begin + 2].low == uses[begin].low && uses[begin + 2].high == uses[begin].high)
            touches[half_cells_[index(uses[begin].cell)].side == kAbove ? 1 : 0] = true;
        for (; end < uses.size() && uses[end].cell == uses[begin].cell &&
               uses[end].low == uses[begin].low && uses[end].high == uses[begin].high;
             ++end)
            sum += uses[end].direction;
        if (sum != 0)
            throw InputError("unresolved",
                             "the surface that cuts crosses itself, or the model does", -1, {},
                             position(uses[begin].low));
    }
    return touches;
}

}  // namespace realmodel::cutting
