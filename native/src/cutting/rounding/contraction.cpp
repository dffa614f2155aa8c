// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/contraction.hpp"

#include <algorithm>
#include <numeric>

#include "arrangement/region_loops.hpp"
#include "base/packed_pair.hpp"
#include "cutting/rounding/equal_pieces.hpp"

namespace realmodel::cutting {

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
bool cancel_folded(Contraction::Scratch& scratch, bool may_fold) {
    using Face = Contraction::Face;
    auto& [faces, nodes, sorted, is_repeated, uses] = scratch;
    std::ranges::sort(faces, [](const Face& f, const Face& g) {
        return std::pair(f.hash, f.begin) < std::pair(g.hash, g.begin);
    });
    const auto of = [](const std::vector<NodeId>& all, const Face& f) {
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

std::optional<Contraction::Shape> Contraction::shape(std::span<const std::int32_t> pieces,
                                                     std::int32_t part, Scratch& scratch) const {
    auto& [faces, nodes, sorted, is_repeated, uses] = scratch;
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
        const int facing = parts_.pieces[index(own)].parts[0] == part ? 1 : -1;
        faces.push_back({arrangement::loop_hash(std::span<const NodeId>(loop)), begin, size,
                         facing * winding_of(loop)});
    }
    if (!cancel_folded(scratch, may_fold_)) return std::nullopt;
    Shape found;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (is_repeated[i] != 0 || faces[i].winding == 0) continue;
        ++found.count;
        const auto loop = std::span(nodes).subspan(faces[i].begin, faces[i].size);
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const auto [a, b] = unordered(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0]);
            uses.push_back(packed_pair(a, b));
            found.box.include(parts_.at(loop[k]));
        }
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 2; i < uses.size(); ++i)
        found.touches += uses[i] == uses[i - 2];
    return found;
}

std::optional<Contraction::Shape> Contraction::shape(std::int32_t part, Scratch& scratch) const {
    return shape(parts_.pieces_of[index(part)], part, scratch);
}

bool Contraction::is_sound(const Shape& shape, std::int32_t part) const {
    if (parts_.has_far_faces[index(part)] != 0) return true;
    if (shape.count < 4) return shape.count == 0 && may_fold_;
    for (std::size_t k = 0; k < 3; ++k) {
        if (shape.box.low[k] == shape.box.high[k]) return false;
    }
    return true;
}

void Contraction::apply() {
    CutPieces kept;
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
        kept.add(pieces, first, p);
        if (p == pieces.size()) break;
        loop.clear();
        add_contracted(p, loop);
        if (!loop.empty()) kept.add(loop, pieces[p]);
    }
    parts_.replace_pieces(std::move(kept));
}

}  // namespace realmodel::cutting
