// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/far_faces.hpp"

#include <atomic>

#include "base/disjoint_sets.hpp"
#include "base/packed_pair.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "cutting/near_part.hpp"

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

/// Calls visit(uses) for runs of uses of the same edge, of those of one node.
template <class Visit>
void each_edge_of(Uses own, const Visit& visit) {
    for (std::size_t begin = 0, end = 0; begin < own.size(); begin = end) {
        while (end < own.size() && greater_of(own[end]) == greater_of(own[begin]))
            ++end;
        visit(own.subspan(begin, end - begin));
    }
}

/// Calls visit(a, b) for the edges of a loop, as it runs.
template <class Visit>
void each_edge_in(std::span<const NodeId> loop, const Visit& visit) {
    for (std::size_t k = 0; k < loop.size(); ++k)
        visit(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0]);
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
    auto stays = zeros<std::uint8_t>(count, execution);
    parallel_ranges(count, kEdgeChunk, execution, [&](std::size_t begin, std::size_t end) {
        spatial::Box around;
        for (std::size_t i = begin; i < end; ++i) {
            const spatial::Box box = box_of(model, faces[i]);
            if (surface.is_near(box, margin) || is_upright(model, faces[i], box)) stays[i] = 1;
            around.include(box);
        }
        include_at_once(box_, around);
    });
    const auto uses = sorted_in_buckets<std::uint64_t>(
        model.vertex_count(), (count + kEdgeChunk - 1) / kEdgeChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kEdgeChunk; i < std::min(count, (chunk + 1) * kEdgeChunk);
                 ++i) {
                each_edge_in(model.face(index(faces[i])), [&](NodeId a, NodeId b) {
                    put(index(std::min(a, b)), packed_use(std::max(a, b), i, b < a));
                });
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
    const auto uses_of = [&uses](NodeId a, NodeId b) {
        const Uses own = uses[index(std::min(a, b))];
        const auto first = std::ranges::lower_bound(own, std::max(a, b), {}, greater_of);
        return Uses(first, std::ranges::upper_bound(own, std::max(a, b), {}, greater_of));
    };
    parallel_each(count, execution, [&](std::size_t i) {
        if (!has(i, 1)) return;
        each_edge_in(model.face(index(faces[i])), [&](NodeId a, NodeId b) {
            for (const std::uint64_t use : uses_of(a, b))
                note(face_of(use), 2);
        });
    });
    DisjointSets joined(count);
    const auto is_within = [&](Uses own) {
        if (own.size() != 2 || ((own[0] ^ own[1]) & 1) == 0) return false;
        const std::size_t one = face_of(own[0]), other = face_of(own[1]);
        return !has(one, 3) && !has(other, 3) &&
               model.cell(index(faces[one]), 0) == model.cell(index(faces[other]), 0) &&
               model.cell(index(faces[one]), 1) == model.cell(index(faces[other]), 1);
    };
    parallel_each(uses.size(), execution, [&](std::size_t node) {
        each_edge_of(uses[node], [&](Uses own) {
            if (is_within(own)) {
                joined.join(static_cast<std::int32_t>(face_of(own[0])),
                            static_cast<std::int32_t>(face_of(own[1])));
            } else {
                for (const std::uint64_t use : own)
                    note(face_of(use), 4);
            }
        });
    });
    // groups in the order of their first faces
    const auto root_of = [&](std::size_t i) {
        return index(joined.find(static_cast<std::int32_t>(i)));
    };
    auto is_group = zeros<std::uint8_t>(count, execution);
    Array<std::int32_t> number(count);
    parallel_each(count, execution, [&](std::size_t i) {
        number[i] = -1;
        if (root_of(i) == i) {
            note(i, 4);
        } else if (!has(i, 7)) {
            mark(is_group[root_of(i)]);
        }
    });
    number_in_order(
        count, execution, [&](std::size_t i) { return is_group[i] != 0; },
        [this](std::size_t groups) { first_.resize(groups); },
        [&](std::size_t i, std::size_t group) { number[i] = static_cast<std::int32_t>(group); });
    std::vector<std::int32_t> kept;
    number_in_order(
        count, execution, [&](std::size_t i) { return stays[i] != 0; },
        [&](std::size_t size) {
            kept.resize(size);
            group_.resize(size);
        },
        [&](std::size_t i, std::size_t place) {
            kept[place] = faces[i];
            group_[place] = number[root_of(i)];
            if (number[i] >= 0) first_[index(number[i])] = static_cast<std::int32_t>(place);
        });
    number_in_order(
        count, execution, [&](std::size_t i) { return stays[i] == 0; },
        [this](std::size_t size) {
            faces_.resize(size);
            groups_of_faces_.resize(size);
        },
        [&](std::size_t i, std::size_t place) {
            faces_[place] = faces[i];
            groups_of_faces_[place] = number[root_of(i)];
        });
    of_group_ = bucketize_in_order<std::int32_t>(
        first_.size(), (faces_.size() + kEdgeChunk - 1) / kEdgeChunk,
        [this](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kEdgeChunk;
                 i < std::min(faces_.size(), (chunk + 1) * kEdgeChunk); ++i)
                put(index(groups_of_faces_[i]), faces_[i]);
        },
        execution);
    for (std::size_t place = 0; place < kept.size(); ++place) {
        if (group_[place] < 0) continue;
        each_edge_in(model.face(index(kept[place])), [&](NodeId a, NodeId b) {
            const Uses own = uses_of(a, b);
            if (is_within(own) && !(has(face_of(own[0]), 7) && has(face_of(own[1]), 7)))
                edges_.push_back(packed_pair(std::min(a, b), std::max(a, b)));
        });
    }
    std::ranges::sort(edges_);
    faces = std::move(kept);
}

void FarFaces::renumber(std::span<const NodeId> number) {
    for (std::uint64_t& edge : edges_) {
        const auto [a, b] = unpacked_pair(edge);
        edge = packed_pair(number[index(a)], number[index(b)]);
    }
}

}  // namespace realmodel::cutting
