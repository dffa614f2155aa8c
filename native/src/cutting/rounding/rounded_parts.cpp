// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/rounded_parts.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace realmodel::cutting {

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
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    Positions found;
    return std::ranges::all_of(nodes, [&](NodeId node) { return found.insert(at(node)); });
}

void RoundedParts::update() {
    const std::size_t nodes = vertices.size() + new_positions.size();
    for (auto* of_nodes : {&on_base, &on_wall, &is_near})
        of_nodes->assign(nodes, 0);
    parallel_ranges(pieces.size(), 1 << 12, execution, [this](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            // whole cells, too, get new polygons where they meet the cutter
            const bool changed = !is_whole_face(p) || pieces[p].is_level ||
                                 std::ranges::any_of(pieces[p].parts, [this](std::int32_t part) {
                                     return part >= 0 && is_changed(part);
                                 });
            const std::int32_t surface = surface_of(p, kCutFace);
            for (const NodeId node : pieces.polygons[p]) {
                if (changed) mark(is_near[index(node)]);
                if (surface == kBase) mark(on_base[index(node)]);
                if (surface == kWall) mark(on_wall[index(node)]);
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

}  // namespace realmodel::cutting
