// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/rounded_parts.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "arrangement/polygons.hpp"
#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

Position free_position_beside(const Position& p, Freedom freedom, Positions& taken) {
    constexpr int kUpright = 4;  // units up or down that are tried before a point is moved aside
    // each try is another position, so no more of them can fail than positions are taken
    std::size_t tries = 0;
    for (int reach = 1;; ++reach) {
        const int aside = freedom == Freedom::kUpright && reach <= kUpright ? 0 : reach;
        const int upward = freedom == Freedom::kLevel ? 0 : reach;
        for (int x = -aside; x <= aside; ++x) {
            for (int y = -aside; y <= aside; ++y) {
                for (int z = -upward; z <= upward; ++z) {
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach) continue;
                    const Position to{moved_by_ulps(p[0], x), moved_by_ulps(p[1], y),
                                      moved_by_ulps(p[2], z)};
                    if (taken.insert(to)) return to;
                    if (++tries > taken.size())
                        throw InternalError("a position beside another one is free", p);
                }
            }
        }
    }
}

RoundedParts::RoundedParts(const ComplexView& of, std::vector<Position>& positions,
                           CutPieces& polygons, std::vector<HalfCell>& cells, bool of_several,
                           const Execution& executed, const FarFaces& far)
    : model(of),
      new_positions(positions),
      pieces(polygons),
      half_cells(cells),
      are_joined(of_several),
      execution(executed),
      has_far_faces(cells.size(), 0) {
    checked_number(model.vertex_count() + new_positions.size(), "vertices and new nodes");
    vertices.reserve(model.vertex_count());
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        vertices.push_back(model.vertex(static_cast<NodeId>(v)));
    parts_of_.assign(model.cell_block.size(), 0);
    for (const HalfCell& part : half_cells) {
        auto& count = parts_of_[index(part.cell)];
        count = static_cast<std::uint8_t>(std::min(count + 1, 2));
    }
    for (const CutPiece& piece : pieces.origins) {
        if (piece.face < 0 || !far.is_first(index(piece.face))) continue;
        for (const std::int32_t part : piece.parts) {
            if (part >= 0) has_far_faces[index(part)] = 1;
        }
    }
    update();
}

/// New nodes are set apart from what is near them; those that are added later may lie between two
/// vertices that are away from all of them.
NodeId RoundedParts::add_node(Position p, Freedom freedom) {
    if (!std::exchange(has_taken_all_, true)) {
        for (const Position& vertex : vertices)
            taken.insert(vertex);
    }
    if (!taken.insert(p)) p = free_position_beside(p, freedom, taken);
    new_positions.push_back(p);
    return checked_number(vertices.size() + new_positions.size(), "vertices and new nodes") - 1;
}

Freedom RoundedParts::freedom_of(std::span<const NodeId> nodes) const {
    const auto are_on = [nodes](const std::vector<std::uint8_t>& faces) {
        return std::ranges::all_of(nodes, [&](NodeId node) { return faces[index(node)] != 0; });
    };
    return are_on(on_base) ? Freedom::kLevel : are_on(on_wall) ? Freedom::kUpright : Freedom::kAny;
}

bool RoundedParts::is_upright(std::size_t piece) const {
    const auto corners = pieces.polygons[piece];
    return may_be_wall(piece) && std::ranges::all_of(corners, [&](NodeId node) {
               return at(node)[0] == at(corners[0])[0] && at(node)[1] == at(corners[0])[1];
           });
}

bool RoundedParts::is_whole_face(std::size_t piece) const {
    const std::int32_t face = pieces[piece].face;
    return face >= 0 && std::ranges::equal(pieces.polygons[piece], model.face(index(face)));
}

bool RoundedParts::are_closed() const {
    if (std::ranges::count(has_far_faces, 1) > 0) return true;  // not without what was left out
    std::map<std::pair<std::int32_t, std::array<NodeId, 2>>, int> sums;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const auto nodes = pieces.polygons[p];
        for (std::size_t i = 0; i < 2 * nodes.size(); ++i) {
            const std::int32_t part = pieces[p].parts[i % 2];
            const NodeId a = nodes[i / 2], b = nodes[(i / 2 + 1) % nodes.size()];
            if (part >= 0) sums[{part, unordered(a, b)}] += (a < b) == (i % 2 == 0) ? 1 : -1;
        }
    }
    return std::ranges::all_of(sums, [](const auto& sum) { return sum.second == 0; });
}

bool RoundedParts::are_apart() const {
    std::vector<NodeId> nodes = pieces.polygons.nodes;
    sort_unique(nodes);
    Positions positions;
    return std::ranges::all_of(nodes, [&](NodeId node) { return positions.insert(at(node)); });
}

void RoundedParts::update() {
    const std::size_t nodes = vertices.size() + new_positions.size();
    for (auto* of_nodes : {&on_base, &on_wall, &is_near})
        of_nodes->assign(nodes, 0);
    parallel_ranges(pieces.size(), 1 << 12, execution, [this](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            // whole cells, too, get new polygons where they meet the cutter
            const bool changed = !is_whole_face(p) || pieces[p].is_on_cutter ||
                                 std::ranges::any_of(pieces[p].parts, [this](std::int32_t part) {
                                     return part >= 0 && is_changed(part);
                                 });
            const std::int32_t surface = surface_of(p, kCutFace);
            for (const NodeId node : pieces.polygons[p]) {
                if (changed) atomic_set(is_near[index(node)]);
                if (surface == kBase) atomic_set(on_base[index(node)]);
                if (surface == kWall) atomic_set(on_wall[index(node)]);
            }
        }
    });
    pieces_of = bucketize<std::int32_t>(half_cells.size(), [this](const auto& visit) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            for (const std::int32_t part : pieces[p].parts) {
                if (part >= 0) visit(index(part), static_cast<std::int32_t>(p));
            }
        }
    });
}

int winding_of(std::span<const NodeId> loop) {
    const std::size_t n = loop.size();
    const auto least = static_cast<std::size_t>(std::ranges::min_element(loop) - loop.begin());
    return loop[(least + 1) % n] < loop[(least + n - 1) % n] ? 1 : -1;
}

void put_first(std::span<const NodeId> loop, std::vector<NodeId>& nodes) {
    const auto least = std::ranges::min_element(loop);
    nodes.assign(least, loop.end());
    nodes.insert(nodes.end(), loop.begin(), least);
    if (winding_of(nodes) < 0) std::reverse(nodes.begin() + 1, nodes.end());
}

std::vector<std::vector<std::size_t>> equal_pieces(const RoundedParts& parts) {
    const CutPieces& pieces = parts.pieces;
    // how many have the same hash, up to 2: only of these the nodes are compared
    std::vector<std::uint8_t> count(std::bit_ceil(8 * pieces.size() + 1), 0);
    constexpr std::size_t kFar = SIZE_MAX;
    Array<std::size_t> bucket(pieces.size());
    parallel_ranges(
        pieces.size(), 1 << 12, parts.execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                const auto nodes = pieces.polygons[p];
                const bool is_near = std::ranges::all_of(
                    nodes, [&](NodeId node) { return parts.is_near[index(node)] != 0; });
                bucket[p] = is_near ? arrangement::loop_hash(nodes) & (count.size() - 1) : kFar;
            }
        },
        0.05);
    for (const std::size_t hash : bucket) {
        if (hash != kFar) count[hash] = static_cast<std::uint8_t>(std::min(count[hash] + 1, 2));
    }
    std::vector<std::pair<std::vector<NodeId>, std::size_t>> order;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (bucket[p] != kFar && count[bucket[p]] > 1)
            put_first(pieces.polygons[p], order.emplace_back(std::vector<NodeId>(), p).first);
    }
    std::ranges::sort(order);
    std::vector<std::vector<std::size_t>> groups;
    using Ordered = std::pair<std::vector<NodeId>, std::size_t>;
    for (const auto equal : groups_of(order, &Ordered::first)) {
        if (equal.size() > 1) groups.push_back(transformed(equal, &Ordered::second));
    }
    return groups;
}

Contraction::Contraction(RoundedParts& parts, bool may_fold)
    : becomes(parts.vertices.size() + parts.new_positions.size()),
      parts_(parts),
      may_fold_(may_fold) {
    std::iota(becomes.begin(), becomes.end(), 0);
}

/// Adds a piece's nodes without those that became the one before; none where it vanishes.
void Contraction::add_contracted(std::size_t piece, std::vector<NodeId>& nodes) const {
    const std::size_t begin = nodes.size();
    for (const NodeId node : parts_.pieces.polygons[piece]) {
        const NodeId now = becomes[index(node)];
        if (nodes.size() == begin || nodes.back() != now) nodes.push_back(now);
    }
    while (nodes.size() > begin + 1 && nodes[begin] == nodes.back())
        nodes.pop_back();
    if (nodes.size() < begin + 3) nodes.resize(begin);
}

namespace {

/// Sorts faces and marks those that are another once more; false where two have the same nodes
/// otherwise.
bool cancel_folded(Contraction::ShapeScratch& scratch, bool may_fold) {
    using ContractedPolygon = Contraction::ContractedPolygon;
    auto& [faces, nodes, sorted, is_repeated, uses] = scratch;
    std::ranges::sort(faces, [](const ContractedPolygon& f, const ContractedPolygon& g) {
        return std::pair(f.hash, f.begin) < std::pair(g.hash, g.begin);
    });
    const auto of = [](const std::vector<NodeId>& all, const ContractedPolygon& f) {
        return std::span(all).subspan(f.begin, f.size);
    };
    std::vector<NodeId> one, other;
    is_repeated.assign(faces.size(), 0);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t j = i; j-- > 0 && faces[j].hash == faces[i].hash;) {
            if (is_repeated[j] != 0 ||
                !std::ranges::equal(of(sorted, faces[i]), of(sorted, faces[j])))
                continue;
            // the same nodes in another order: corners in one line, of polygons without an extent
            put_first(of(nodes, faces[i]), one);
            put_first(of(nodes, faces[j]), other);
            if (!may_fold || faces[j].winding + faces[i].winding != 0 || one != other) return false;
            faces[j].winding = 0;
            is_repeated[i] = 1;
            break;
        }
    }
    return true;
}

}  // namespace

std::optional<Contraction::PartShape> Contraction::shape(std::span<const std::int32_t> pieces,
                                                         std::int32_t part,
                                                         ShapeScratch& scratch) const {
    auto& [faces, nodes, sorted, is_repeated, uses] = scratch;
    faces.clear();
    nodes.clear();
    sorted.clear();
    uses.clear();
    for (const std::int32_t piece : pieces) {
        const std::size_t begin = nodes.size();
        add_contracted(index(piece), nodes);
        const std::size_t size = nodes.size() - begin;
        if (size == 0) continue;
        const std::span loop(nodes.data() + begin, size);
        sorted.insert(sorted.end(), loop.begin(), loop.end());
        const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
        std::sort(first, sorted.end());
        if (std::adjacent_find(first, sorted.end()) != sorted.end()) return std::nullopt;
        const int facing = parts_.pieces[index(piece)].parts[0] == part ? 1 : -1;
        faces.push_back({arrangement::loop_hash(std::span<const NodeId>(loop)), begin, size,
                         facing * winding_of(loop)});
    }
    if (!cancel_folded(scratch, may_fold_)) return std::nullopt;
    PartShape shape;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (is_repeated[i] != 0 || faces[i].winding == 0) continue;
        ++shape.count;
        const auto loop = std::span(nodes).subspan(faces[i].begin, faces[i].size);
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const auto [a, b] = unordered(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0]);
            uses.push_back(packed_pair(a, b));
            shape.box.include(parts_.at(loop[k]));
        }
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 2; i < uses.size(); ++i)
        shape.touches += uses[i] == uses[i - 2];
    return shape;
}

std::optional<Contraction::PartShape> Contraction::shape(std::int32_t part,
                                                         ShapeScratch& scratch) const {
    return shape(parts_.pieces_of[index(part)], part, scratch);
}

bool Contraction::is_sound(const PartShape& shape, std::int32_t part) const {
    if (parts_.has_far_faces[index(part)] != 0) return true;
    if (shape.count < 4) return shape.count == 0 && may_fold_;
    for (std::size_t k = 0; k < 3; ++k) {
        if (shape.box.low[k] == shape.box.high[k]) return false;
    }
    return true;
}

void Contraction::apply() {
    CutPieces contracted;
    std::vector<NodeId> loop;
    // what a node became stays: no chains
    assert(std::ranges::all_of(becomes, [this](NodeId n) { return becomes[index(n)] == n; }));
    const CutPieces& pieces = parts_.pieces;
    const auto stays = [&](std::size_t p) {
        return std::ranges::all_of(pieces.polygons[p],
                                   [this](NodeId n) { return becomes[index(n)] == n; });
    };
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const std::size_t first = p;
        while (p < pieces.size() && stays(p))
            ++p;
        contracted.add(pieces, first, p);
        if (p == pieces.size()) break;
        loop.clear();
        add_contracted(p, loop);
        if (!loop.empty()) contracted.add(loop, pieces[p]);
    }
    parts_.replace_pieces(std::move(contracted));
}

}  // namespace realmodel::cutting
