// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/part_rounding.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/parallel.hpp"

namespace realmodel::cutting {

using spatial::Box;

PartRounding::PartRounding(const ComplexView& model, std::vector<Position>& new_positions,
                           Pieces& pieces, std::vector<HalfCell>& half_cells,
                           const std::array<bool, 2>& touches, const Execution& execution,
                           bool joins_models, double least_rounding)
    : model_(model),
      new_positions_(new_positions),
      pieces_(pieces),
      half_cells_(half_cells),
      touches_(touches),
      execution_(execution),
      joins_models_(joins_models),
      least_rounding_(least_rounding) {
    checked_number(model.vertex_count() + new_positions.size(), "vertices and new nodes");
    vertices_.reserve(model.vertex_count());
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        vertices_.push_back(model.vertex(static_cast<NodeId>(v)));
    parts_of_.assign(model.cell_block.size(), 0);
    for (const HalfCell& part : half_cells) {
        auto& count = parts_of_[index(part.cell)];
        count = static_cast<std::uint8_t>(std::min(count + 1, 2));
    }
}

const Position& PartRounding::at(NodeId node) const {
    return is_new(node) ? new_positions_[index(node) - model_.vertex_count()]
                        : vertices_[index(node)];
}

/// Whether a part is less than the model's cell, which was sound.
bool PartRounding::is_changed(std::int32_t part) const {
    const HalfCell& own = half_cells_[index(part)];
    return own.is_changed || parts_of_[index(own.cell)] > 1;
}

bool PartRounding::is_wall(std::size_t piece) const {
    const std::int32_t face = pieces_[piece].face;
    return face >= 0 && model_.face_surface[index(face)] == kWall;
}

/// The first of so many things that is what is asked for, their number where none is. Several
/// threads ask at once.
template <class IsIt>
std::size_t PartRounding::first_where(std::size_t count, const IsIt& is_it) const {
    std::atomic<std::size_t> first{count};
    parallel_ranges(
        count, 1 << 12, execution_,
        [&](std::size_t begin, std::size_t end) {
            if (first.load(std::memory_order_relaxed) < begin) return;
            std::size_t i = begin;
            while (i < end && !is_it(i))
                ++i;
            auto known = first.load(std::memory_order_relaxed);
            while (i < end && i < known &&
                   !first.compare_exchange_weak(known, i, std::memory_order_relaxed)) {
            }
        },
        0.05);
    return first;
}

void PartRounding::run() {
    find_pieces_of_parts();
    drop_hollow();  // of a cell that lies flat on the cutter
    level_base();
    contract();
    if (joins_models_) cancel_doubled();
    set_apart();
    give_extents();
    glue_doubled();
    divide_bent();
    if (joins_models_) {
        find_pieces_of_parts();
        cancel_doubled();
        set_touching_apart();
    }
    drop_empty();
}

/// Whether a polygon is a face of the model as it was.
bool PartRounding::is_whole_face(std::size_t piece) const {
    const std::int32_t face = pieces_[piece].face;
    return face >= 0 && std::ranges::equal(pieces_.polygons[piece], model_.face(index(face)));
}

void PartRounding::find_pieces_of_parts() {
    const std::size_t nodes = model_.vertex_count() + new_positions_.size();
    on_base_.assign(nodes, 0);
    on_wall_.assign(nodes, 0);
    is_near_.assign(nodes, 0);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        // of joined models whole cells, too, get new polygons where they meet a structure
        const bool changed = (joins_models_ && (!is_whole_face(p) || pieces_[p].is_level)) ||
                             std::ranges::any_of(pieces_[p].parts, [this](std::int32_t part) {
                                 return part >= 0 && is_changed(part);
                             });
        if (!changed) continue;
        for (const NodeId node : pieces_.polygons[p])
            is_near_[index(node)] = 1;
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const std::int32_t face = pieces_[p].face;
        if (face < 0) continue;
        const std::int32_t surface = model_.face_surface[index(face)];
        if (surface != kBase && surface != kWall) continue;
        for (const NodeId node : pieces_.polygons[p])
            (surface == kBase ? on_base_ : on_wall_)[index(node)] = 1;
    }
    pieces_of_ = bucketize<std::int32_t>(half_cells_.size(), [this](const auto& visit) {
        for (std::size_t p = 0; p < pieces_.size(); ++p) {
            for (const std::int32_t part : pieces_[p].parts) {
                if (part >= 0) visit(index(part), static_cast<std::int32_t>(p));
            }
        }
    });
}

/// A cutter that runs along the base but for rounding is taken to run along it: so do its nodes.
void PartRounding::level_base() {
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const std::int32_t face = pieces_[p].face;
        if (face < 0 || model_.face_surface[index(face)] != kBase) continue;
        const double height = vertices_[index(model_.face(index(face))[0])][2];
        for (const NodeId node : pieces_.polygons[p]) {
            if (is_new(node)) moving(node)[2] = height;
        }
    }
}

namespace {

/// Which way round a loop goes from its least node to its second least.
int winding_of(std::span<const NodeId> nodes) {
    const auto least =
        static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
    const std::size_t n = nodes.size();
    return nodes[(least + 1) % n] < nodes[(least + n - 1) % n] ? 1 : -1;
}

/// The nodes of a loop from its least one on, toward the lesser of the two beside that: the same
/// for loops that pass the same edges.
void put_first(std::span<const NodeId> loop, std::vector<NodeId>& nodes) {
    const auto least = std::min_element(loop.begin(), loop.end());
    nodes.assign(least, loop.end());
    nodes.insert(nodes.end(), loop.begin(), least);
    if (winding_of(nodes) < 0) std::reverse(nodes.begin() + 1, nodes.end());
}

/// The same for equal nodes in any order.
std::uint64_t hash_of(std::span<const NodeId> nodes) {
    std::uint64_t hash = nodes.size();
    for (const NodeId node : nodes)
        hash += KeyTable::hash(std::array{static_cast<std::uint64_t>(node)});
    return hash;
}

}  // namespace

/// Adds a piece's nodes without those that became the one before; none where it vanishes.
void PartRounding::add_contracted(std::size_t piece, std::vector<NodeId>& nodes) const {
    const std::size_t begin = nodes.size();
    for (const NodeId node : pieces_.polygons[piece]) {
        const NodeId now = becomes_[index(node)];
        if (nodes.size() == begin || nodes.back() != now) nodes.push_back(now);
    }
    while (nodes.size() > begin + 1 && nodes[begin] == nodes.back())
        nodes.pop_back();
    if (nodes.size() < begin + 3) nodes.resize(begin);
}

/// What some of the polygons of a part are like, as contractions leave them. None where a polygon
/// passes a node twice, or two have the same nodes. Where models are joined, two that are the same
/// and face each other make up for each other.
std::optional<PartRounding::Around> PartRounding::around(std::span<const std::int32_t> pieces,
                                                         std::int32_t part, Memory& memory) const {
    auto& [faces, nodes, sorted, is_repeated, uses] = memory;
    faces.clear();
    nodes.clear();
    sorted.clear();
    uses.clear();
    for (const std::int32_t own : pieces) {
        const std::size_t begin = nodes.size();
        add_contracted(index(own), nodes);
        const std::size_t size = nodes.size() - begin;
        if (size == 0) continue;
        const std::span loop(nodes.data() + begin, size);
        sorted.insert(sorted.end(), loop.begin(), loop.end());
        const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
        std::sort(first, sorted.end());
        if (std::adjacent_find(first, sorted.end()) != sorted.end()) return std::nullopt;
        const int facing = pieces_[index(own)].parts[0] == part ? 1 : -1;
        faces.push_back({hash_of(loop), begin, size, facing * winding_of(loop)});
    }
    std::ranges::sort(faces, [](const Face& f, const Face& g) {
        return std::pair(f.hash, f.begin) < std::pair(g.hash, g.begin);
    });
    const auto have_equal_nodes = [&listed = memory.sorted](const Face& f, const Face& g) {
        return std::ranges::equal(std::span(listed).subspan(f.begin, f.size),
                                  std::span(listed).subspan(g.begin, g.size));
    };
    std::vector<NodeId> one, other;
    const auto are_equal = [&, &listed = memory.nodes](const Face& f, const Face& g) {
        put_first(std::span(listed).subspan(f.begin, f.size), one);
        put_first(std::span(listed).subspan(g.begin, g.size), other);
        return one == other;
    };
    is_repeated.assign(faces.size(), 0);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t j = i; j-- > 0 && faces[j].hash == faces[i].hash;) {
            if (is_repeated[j] != 0 || !have_equal_nodes(faces[i], faces[j])) continue;
            // the same nodes in another order: corners in one line, of polygons without an extent
            if (!joins_models_ || faces[j].winding + faces[i].winding != 0 ||
                !are_equal(faces[i], faces[j]))
                return std::nullopt;
            faces[j].winding = 0;
            is_repeated[i] = 1;
            break;
        }
    }
    Around found;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (is_repeated[i] != 0 || faces[i].winding == 0) continue;
        ++found.count;
        const auto loop = std::span(nodes).subspan(faces[i].begin, faces[i].size);
        for (std::size_t k = 0; k < loop.size(); ++k) {
            uses.push_back(number_of(unordered(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0])));
            found.box.include(at(loop[k]));
        }
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 2; i < uses.size(); ++i)
        found.touches += uses[i] == uses[i - 2];
    return found;
}

/// The same of a whole part; none where it has no extent, either.
std::optional<PartRounding::Around> PartRounding::around(std::int32_t part, Memory& memory) const {
    const auto found = around(pieces_of_[index(part)], part, memory);
    if (!found || found->count < 4) return std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
        if (found->box.low[k] == found->box.high[k]) return std::nullopt;
    }
    return found;
}

/// Whether a part would still be closed, with polygons that pass no node twice, none of them twice
/// there, and an extent.
bool PartRounding::stays_sound(std::int32_t part, Memory& memory) const {
    const auto found = around(part, memory);
    return found && (found->touches == 0 || model_.cell_kind == CellKind::kBlocks ||
                     touches_[half_cells_[index(part)].side == kAbove ? 1 : 0]);
}

/// Notes of new nodes that came to lie where a vertex of the model or an earlier new node is that
/// they become it.
/// @return these nodes
std::vector<NodeId> PartRounding::find_contractions() {
    const auto is_at = [this](const Position& p) {
        return [this, &p](std::int32_t i) { return new_positions_[index(i)] == p; };
    };
    KeyTable first;  // of the new nodes in one position
    first.reserve(new_positions_.size());
    std::vector<NodeId> stands(new_positions_.size());  // for a new node
    Box box;
    for (std::size_t i = 0; i < new_positions_.size(); ++i) {
        const Position& p = new_positions_[i];
        box.include(p);
        const auto own = static_cast<std::int32_t>(i);
        const std::int32_t found = first.find_or_add(hash_of(p), own, is_at(p)).number;
        stands[i] = static_cast<NodeId>(vertices_.size()) + found;
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        if (!box.contains(vertices_[v])) continue;
        const std::int32_t found = first.find(hash_of(vertices_[v]), is_at(vertices_[v]));
        if (found >= 0) stands[index(found)] = static_cast<NodeId>(v);
    }
    becomes_.resize(vertices_.size() + new_positions_.size());
    std::iota(becomes_.begin(), becomes_.end(), 0);
    for (std::size_t i = 0; i < new_positions_.size(); ++i) {
        const std::size_t node = vertices_.size() + i;
        // that of the first in its position may be a vertex
        becomes_[node] = index(stands[i]) < node && index(stands[i]) >= vertices_.size()
                             ? stands[index(stands[i]) - vertices_.size()]
                             : stands[i];
    }
    std::vector<NodeId> contracted;
    for (std::size_t node = vertices_.size(); node < becomes_.size(); ++node) {
        if (index(becomes_[node]) != node) contracted.push_back(static_cast<NodeId>(node));
    }
    return contracted;
}

/// Takes contractions back until all parts around those that are left stay sound.
void PartRounding::keep_sound(const std::vector<NodeId>& contracted) {
    std::vector<std::uint8_t> is_involved(becomes_.size(), 0);
    for (const NodeId node : contracted)
        is_involved[index(node)] = is_involved[index(becomes_[index(node)])] = 1;
    std::set<std::int32_t> open;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        if (std::ranges::none_of(pieces_.polygons[p],
                                 [&](NodeId node) { return is_involved[index(node)] != 0; }))
            continue;
        for (const std::int32_t part : pieces_[p].parts) {
            if (part >= 0) open.insert(part);
        }
    }
    const auto each_contracted = [this](std::int32_t part, const auto& visit) {
        for (const std::int32_t piece : pieces_of_[index(part)]) {
            for (const NodeId node : pieces_.polygons[index(piece)]) {
                if (becomes_[index(node)] != node) visit(node);
            }
        }
    };
    std::map<NodeId, std::set<std::int32_t>> parts_at;
    for (const std::int32_t part : open)
        each_contracted(part, [&](NodeId node) { parts_at[node].insert(part); });
    // what all of them are like at first is found on all threads
    const std::vector<std::int32_t> parts(open.begin(), open.end());
    std::vector<std::uint8_t> is_sound(half_cells_.size(), 0), is_known(half_cells_.size(), 0);
    each_of_parts(parts, [&](std::size_t i, Memory& memory) {
        is_sound[index(parts[i])] = stays_sound(parts[i], memory) ? 1 : 0;
        is_known[index(parts[i])] = 1;
    });
    Memory memory;
    while (!open.empty()) {
        const std::int32_t part = *open.begin();
        open.erase(open.begin());
        if (is_known[index(part)] != 0 ? is_sound[index(part)] != 0 : stays_sound(part, memory))
            continue;
        // its nodes stay apart; the parts around these are looked at again
        each_contracted(part, [&](NodeId node) {
            becomes_[index(node)] = node;
            for (const std::int32_t other : parts_at[node]) {
                open.insert(other);
                is_known[index(other)] = 0;
            }
        });
        open.erase(part);
    }
}

void PartRounding::contract() {
    const std::vector<NodeId> nodes = find_contractions();
    if (!nodes.empty()) {
        keep_sound(nodes);
        contract_pieces();
    }
    if (joins_models_ && join_short_edges()) contract_pieces();
}

void PartRounding::contract_pieces() {
    Pieces kept;
    std::vector<NodeId> loop;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        loop.clear();
        add_contracted(p, loop);
        if (!loop.empty()) kept.add(loop, pieces_[p]);
    }
    pieces_ = std::move(kept);
    find_pieces_of_parts();
}

/// Pieces near the cutter with their nodes as put_first() has them, in the order of these: among
/// them all that are equal to others.
std::vector<std::pair<std::vector<NodeId>, std::size_t>> PartRounding::find_doubled() const {
    // how many have the same hash, up to 2
    std::vector<std::uint8_t> count(std::bit_ceil(8 * pieces_.size() + 1), 0);
    constexpr std::size_t kFar = SIZE_MAX;
    Array<std::size_t> slot(pieces_.size());
    parallel_ranges(
        pieces_.size(), 1 << 12, execution_,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                const auto nodes = pieces_.polygons[p];
                const bool is_near = std::ranges::all_of(
                    nodes, [this](NodeId node) { return is_near_[index(node)] != 0; });
                slot[p] = is_near ? hash_of(nodes) & (count.size() - 1) : kFar;
            }
        },
        0.05);
    for (const std::size_t own : slot) {
        if (own != kFar) count[own] = static_cast<std::uint8_t>(std::min(count[own] + 1, 2));
    }
    std::vector<std::pair<std::vector<NodeId>, std::size_t>> found;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        if (slot[p] == kFar || count[slot[p]] < 2) continue;
        const auto nodes = pieces_.polygons[p];
        put_first(nodes, found.emplace_back(std::vector<NodeId>(), p).first);
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// Of polygons that are the same, those that face each other within one part make up for each
/// other: what is left is between the others.
void PartRounding::cancel_doubled() {
    const auto order = find_doubled();
    std::vector<std::uint8_t> is_gone(pieces_.size(), 0);
    bool any = false;
    Pieces fresh;
    std::vector<std::size_t> same;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        same.clear();
        for (; end < order.size() && order[end].first == order[begin].first; ++end)
            same.push_back(order[end].second);
        if (same.size() < 2) continue;
        std::map<std::int32_t, int> facing;  // of parts: how often a polygon faces away from each
        std::size_t before = 0;
        for (const std::size_t p : same) {
            const int winding = winding_of(pieces_.polygons[p]);
            for (std::size_t k = 0; k < 2; ++k) {
                if (pieces_[p].parts[k] < 0) continue;
                facing[pieces_[p].parts[k]] += k == 0 ? winding : -winding;
                ++before;
            }
        }
        std::array<std::vector<std::int32_t>, 2> left;  // parts that it faces away from, and faces
        for (const auto& [part, times] : facing)
            left[times > 0 ? 0 : 1].insert(left[times > 0 ? 0 : 1].end(), std::abs(times), part);
        if (left[0].size() + left[1].size() == before) continue;
        any = true;
        const Piece first = pieces_[same[0]];
        std::vector<NodeId> nodes(pieces_.polygons[same[0]].begin(),
                                  pieces_.polygons[same[0]].end());
        if (winding_of(nodes) < 0) std::reverse(nodes.begin(), nodes.end());
        for (std::size_t i = 0; i < std::max(left[0].size(), left[1].size()); ++i) {
            Piece piece = first;
            for (std::size_t k = 0; k < 2; ++k) {
                const bool has_part = i < left[k].size();
                piece.parts[k] = has_part ? left[k][i] : -1;
                piece.cells[k] = has_part ? half_cells_[index(left[k][i])].cell : -1;
                piece.sides[k] = has_part ? half_cells_[index(left[k][i])].side : kOn;
            }
            fresh.add(nodes, piece);
        }
        for (const std::size_t p : same)
            is_gone[p] = 1;
    }
    for (std::size_t p = 0; any && p < pieces_.size(); ++p) {
        if (is_gone[p] == 0) fresh.add(pieces_.polygons[p], pieces_[p]);
    }
    if (any) {
        pieces_ = std::move(fresh);
        find_pieces_of_parts();
    }
    drop_hollow();
}

/// How a node may move that is where some others are: on all of their faces.
Freedom PartRounding::freedom_of(std::span<const NodeId> nodes) const {
    const auto are_on = [nodes](const std::vector<std::uint8_t>& faces) {
        return std::ranges::all_of(nodes, [&](NodeId node) { return faces[index(node)] != 0; });
    };
    return are_on(on_base_)   ? Freedom::kLevel
           : are_on(on_wall_) ? Freedom::kUpright
                              : Freedom::kAny;
}

/// Moves a node to the nearest free position beside it that its faces allow.
void PartRounding::move_aside(NodeId node) {
    Position& p = moving(node);
    p = free_position_beside(p, freedom_of(std::array{node}), taken_);
}

void PartRounding::set_apart() {
    Box box;
    for (const Position& p : new_positions_)
        box.include(p);
    taken_.reserve(2 * new_positions_.size());
    if (!new_positions_.empty()) box.widen(16 * rounding_of(std::array{box.low, box.high}));
    for (const Position& p : vertices_) {
        if (box.contains(p)) taken_.insert(p);
    }
    std::vector<std::uint8_t> is_used(new_positions_.size(), 0);
    for (const NodeId node : pieces_.polygons.nodes) {
        if (is_new(node)) is_used[index(node) - vertices_.size()] = 1;
    }
    for (std::size_t i = 0; i < new_positions_.size(); ++i) {
        if (is_used[i] == 0) continue;
        const auto node = static_cast<NodeId>(vertices_.size() + i);
        if (!taken_.insert(new_positions_[i])) move_aside(node);
    }
}

/// Of set_apart() it is enough to know what is near new nodes; those that are added later may lie
/// between two vertices that are away from them.
void PartRounding::take_all_vertices() {
    if (has_taken_all_) return;
    has_taken_all_ = true;
    for (const Position& p : vertices_)
        taken_.insert(p);
}

/// Gives parts without thickness on an axis, and walls without extent in plan, one unit of it; of
/// joined models a new polygon may be a wall, too.
void PartRounding::give_extents() {
    const auto widen = [this](std::span<const NodeId> nodes, std::size_t axis, bool free_only) {
        for (const NodeId node : nodes) {
            if (!is_new(node)) continue;
            if (free_only && (axis == 2 ? on_base_ : on_wall_)[index(node)] != 0) continue;
            Position to = at(node);
            for (int i = 0; i < 3; ++i) {
                to[axis] = std::nextafter(to[axis], HUGE_VAL);
                if (!taken_.insert(to)) continue;
                moving(node) = to;
                return true;
            }
        }
        return false;
    };
    const auto box_of = [this](std::size_t part) {
        Box box;
        for (const std::int32_t piece : pieces_of_[part]) {
            for (const NodeId node : pieces_.polygons[index(piece)])
                box.include(at(node));
        }
        return box;
    };
    const auto is_thin = [&](std::size_t part) {
        if (!is_changed(static_cast<std::int32_t>(part))) return false;
        const Box box = box_of(part);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (box.low[axis] == box.high[axis]) return true;
        }
        return false;
    };
    std::vector<NodeId> nodes;
    for (std::size_t part = first_where(half_cells_.size(), is_thin); part < half_cells_.size();
         ++part) {
        if (!is_thin(part)) continue;
        nodes.clear();
        for (const std::int32_t piece : pieces_of_[part]) {
            const auto polygon = pieces_.polygons[index(piece)];
            nodes.insert(nodes.end(), polygon.begin(), polygon.end());
        }
        const Box box = box_of(part);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (box.low[axis] == box.high[axis] && !widen(nodes, axis, true))
                widen(nodes, axis, false);
        }
    }
    const auto upright = [this](std::size_t p) { return is_upright(p); };
    for (std::size_t p = first_where(pieces_.size(), upright); p < pieces_.size(); ++p) {
        const auto corners = pieces_.polygons[p];
        if (is_upright(p) && !widen(corners, 0, false)) widen(corners, 1, false);
    }
}

/// Whether a piece is a wall, or may be one, and without extent in plan.
bool PartRounding::is_upright(std::size_t piece) const {
    if (!is_wall(piece) && !(joins_models_ && pieces_[piece].face < 0)) return false;
    const auto corners = pieces_.polygons[piece];
    return std::ranges::all_of(corners, [&](NodeId node) {
        return at(node)[0] == at(corners[0])[0] && at(node)[1] == at(corners[0])[1];
    });
}

/// Parts that lost all of their polygons to others are no more.
void PartRounding::drop_empty() {
    std::vector<std::int32_t> number(half_cells_.size(), -1);
    for (const Piece& piece : pieces_.origins) {
        for (const std::int32_t own : piece.parts) {
            if (own >= 0) number[index(own)] = 0;
        }
    }
    std::vector<HalfCell> kept;
    for (std::size_t part = 0; part < number.size(); ++part) {
        if (number[part] < 0) continue;
        number[part] = static_cast<std::int32_t>(kept.size());
        kept.push_back(half_cells_[part]);
    }
    half_cells_ = std::move(kept);
    for (Piece& piece : pieces_.origins) {
        for (std::int32_t& own : piece.parts) {
            if (own >= 0) own = number[index(own)];
        }
    }
}

}  // namespace realmodel::cutting
