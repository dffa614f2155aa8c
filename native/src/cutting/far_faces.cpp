// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/far_faces.hpp"

#include "base/disjoint_sets.hpp"
#include "base/packed_pair.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"

namespace realmodel::cutting {

namespace {

constexpr std::size_t kEdgeChunk = 1 << 12;  // nodes or faces at a time

/// Uses of the edges of one node: the greater node, then the face and whether it runs back, in a
/// word.
using Uses = std::span<const std::uint64_t>;
std::uint64_t packed_use(NodeId to, std::size_t face, bool back) {
    return std::uint64_t{static_cast<std::uint32_t>(to)} << 32 | face << 1 | (back ? 1 : 0);
}
NodeId greater_of(std::uint64_t use) {
    return static_cast<NodeId>(use >> 32);
}
std::size_t face_of(std::uint64_t use) {
    return (use & UINT32_MAX) >> 1;
}

/// Calls visit(node, uses) for each edge by its lesser node, from several threads.
template <class Visit>
void each_edge_of(const Buckets<std::uint64_t>& uses, const Execution& execution,
                  const Visit& visit) {
    parallel_ranges(uses.size(), kEdgeChunk, execution, [&](std::size_t first, std::size_t last) {
        for (std::size_t node = first; node < last; ++node) {
            const Uses own = uses[node];
            for (std::size_t begin = 0, end = 0; begin < own.size(); begin = end) {
                while (end < own.size() && greater_of(own[end]) == greater_of(own[begin]))
                    ++end;
                visit(node, own.subspan(begin, end - begin));
            }
        }
    });
}

spatial::Box box_of(const ComplexView& model, std::int32_t face) {
    spatial::Box box;
    for (const NodeId v : model.face(index(face)))
        box.include(model.vertex(v));
    return box;
}

/// Whether rounding has something to do with a face, wherever it is: a wall without extent in plan.
bool is_upright(const ComplexView& model, std::int32_t face, const spatial::Box& box) {
    return model.face_surface[index(face)] == kWall && box.low[0] == box.high[0] &&
           box.low[1] == box.high[1];
}

}  // namespace

FarFaces::FarFaces(const ComplexView& model, std::span<const std::uint8_t> is_near,
                   std::vector<std::int32_t>& faces, const NearestSide& surface, double margin,
                   const Execution& execution)
    : model_(model), is_near_(is_near) {
    const std::size_t count = faces.size();
    // 1 near the surface, 2 beside what is: these have no group; 4 left in for other reasons
    std::vector<std::uint8_t> stays(count, 0);
    std::vector<spatial::Box> boxes(count);
    parallel_each(count, execution, [&](std::size_t i) {
        boxes[i] = box_of(model, faces[i]);
        if (surface.is_near(boxes[i], margin) || is_upright(model, faces[i], boxes[i]))
            stays[i] = 1;
    });
    const auto uses = sorted_in_buckets<std::uint64_t>(
        model.vertex_count(), (count + kEdgeChunk - 1) / kEdgeChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kEdgeChunk; i < std::min(count, (chunk + 1) * kEdgeChunk);
                 ++i) {
                const auto loop = model.face(index(faces[i]));
                for (std::size_t k = 0; k < loop.size(); ++k) {
                    const NodeId a = loop[k], b = loop[k + 1 < loop.size() ? k + 1 : 0];
                    put(index(std::min(a, b)), packed_use(std::max(a, b), i, b < a));
                }
            }
        },
        execution);
    const auto note = [&](std::size_t i, std::uint8_t what) {
        const std::atomic_ref own(stays[i]);
        if ((own.load(std::memory_order_relaxed) & what) == 0)
            own.fetch_or(what, std::memory_order_relaxed);
    };
    const auto has = [&](std::size_t i, int what) {
        return (std::atomic_ref(stays[i]).load(std::memory_order_relaxed) & what) != 0;
    };
    each_edge_of(uses, execution, [&](std::size_t, Uses own) {
        if (std::ranges::none_of(own, [&](auto use) { return has(face_of(use), 1); })) return;
        for (const std::uint64_t use : own)
            note(face_of(use), 2);
    });
    DisjointSets joined(count);
    const auto is_within = [&](Uses own) {
        if (own.size() != 2 || ((own[0] ^ own[1]) & 1) == 0) return false;
        const std::size_t one = face_of(own[0]), other = face_of(own[1]);
        return !has(one, 3) && !has(other, 3) &&
               model.cell(index(faces[one]), 0) == model.cell(index(faces[other]), 0) &&
               model.cell(index(faces[one]), 1) == model.cell(index(faces[other]), 1);
    };
    each_edge_of(uses, execution, [&](std::size_t, Uses own) {
        if (is_within(own)) {
            joined.join(static_cast<std::int32_t>(face_of(own[0])),
                        static_cast<std::int32_t>(face_of(own[1])));
        } else {
            for (const std::uint64_t use : own)
                note(face_of(use), 4);
        }
    });
    parallel_each(count, execution, [&](std::size_t i) {
        if (joined.find(static_cast<std::int32_t>(i)) == static_cast<std::int32_t>(i)) note(i, 4);
    });
    // groups in the order of their first faces
    std::vector<std::int32_t> number(count, -1), kept;
    for (std::size_t i = 0; i < count; ++i) {
        if (stays[i] != 0) continue;
        number[index(joined.find(static_cast<std::int32_t>(i)))] = 0;
        faces_.push_back(faces[i]);
    }
    groups_of_faces_.reserve(faces_.size());
    for (std::size_t i = 0; i < count; ++i) {
        const auto root = index(joined.find(static_cast<std::int32_t>(i)));
        if (root == i && number[i] == 0) {
            number[i] = static_cast<std::int32_t>(first_.size());
            first_.push_back(static_cast<std::int32_t>(kept.size()));
            boxes_.emplace_back();
        }
        if (stays[i] != 0) {
            kept.push_back(faces[i]);
            group_.push_back(number[root]);
        } else {
            groups_of_faces_.push_back(number[root]);
            boxes_[index(number[root])].include(boxes[i]);
        }
    }
    of_group_ = bucketize<std::int32_t>(first_.size(), [this](const auto& put) {
        for (std::size_t i = 0; i < faces_.size(); ++i)
            put(index(groups_of_faces_[i]), faces_[i]);
    });
    std::vector<std::vector<std::uint64_t>> found((uses.size() + kEdgeChunk - 1) / kEdgeChunk);
    each_edge_of(uses, execution, [&](std::size_t node, Uses own) {
        if (is_within(own) && has(face_of(own[0]), 7) != has(face_of(own[1]), 7))
            found[node / kEdgeChunk].push_back(
                packed_pair(static_cast<NodeId>(node), greater_of(own[0])));
    });
    for (const auto& chunk : found)
        edges_.insert(edges_.end(), chunk.begin(), chunk.end());
    faces = std::move(kept);
}

void FarFaces::renumber(std::span<const NodeId> number) {
    for (std::uint64_t& edge : edges_) {
        const auto [a, b] = unpacked_pair(edge);
        edge = packed_pair(number[index(a)], number[index(b)]);
    }
}

}  // namespace realmodel::cutting
