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

/// Which faces of near cells stay, and which of the others are connected.
class Connection {
public:
    Connection(const ComplexView& model, std::span<const std::int32_t> faces,
               const Execution& execution)
        : model_(model),
          faces_(faces),
          execution_(execution),
          stays_(zeros<std::uint8_t>(faces.size(), execution)),
          joined_(faces.size()) {
        const std::size_t chunks = (faces.size() + kEdgeChunk - 1) / kEdgeChunk;
        const auto produce = [&](std::size_t chunk, const auto& put) {
            const std::size_t end = std::min(faces.size(), (chunk + 1) * kEdgeChunk);
            for (std::size_t i = chunk * kEdgeChunk; i < end; ++i) {
                each_edge_of_face(i, [&](NodeId a, NodeId b) {
                    put(index(std::min(a, b)), packed_use(std::max(a, b), i, b < a));
                });
            }
        };
        uses_ = sorted_in_buckets<std::uint64_t>(model.vertex_count(), chunks, produce, execution);
    }

    /// Keeps what is near the surface, and says of what is beside it.
    /// @return around all faces
    spatial::Box keep_near(const NearestSide& surface, double margin) {
        spatial::Box all;
        parallel_ranges(
            faces_.size(), kEdgeChunk, execution_, [&](std::size_t begin, std::size_t end) {
                spatial::Box around;
                for (std::size_t i = begin; i < end; ++i) {
                    const spatial::Box box = box_of(model_, faces_[i]);
                    if (surface.is_near(box, margin) || is_upright(model_, faces_[i], box))
                        stays_[i] = kNear;
                    around.include(box);
                }
                include_at_once(all, around);
            });
        parallel_each(faces_.size(), execution_, [&](std::size_t i) {
            if (!has(i, kNear)) return;
            each_edge_of_face(i, [&](NodeId a, NodeId b) {
                for (const std::uint64_t use : uses_of(a, b))
                    note(face_of(use), kBesideNear);
            });
        });
        return all;
    }

    /// Joins the others across edges that no other faces have, and keeps those with other edges and
    /// the first of each group.
    void join() {
        parallel_each(uses_.size(), execution_, [&](std::size_t node) {
            each_edge_of(uses_[node], [&](Uses own) {
                if (is_within(own)) {
                    joined_.join(static_cast<std::int32_t>(face_of(own[0])),
                                 static_cast<std::int32_t>(face_of(own[1])));
                } else {
                    for (const std::uint64_t use : own)
                        note(face_of(use), kOfGroup);
                }
            });
        });
        parallel_each(faces_.size(), execution_, [&](std::size_t i) {
            if (first_of_group(i) == i) note(i, kOfGroup);
        });
    }

    bool stays(std::size_t i) const { return stays_[i] != 0; }
    std::size_t first_of_group(std::size_t i) {
        return index(joined_.find(static_cast<std::int32_t>(i)));
    }
    /// Calls visit(a, b) for the edges of a face beyond which one of its group does not stay.
    template <class Visit>
    void each_edge_to_left_out(std::size_t i, const Visit& visit) {
        each_edge_of_face(i, [&](NodeId a, NodeId b) {
            const Uses own = uses_of(a, b);
            if (is_within(own) && !(stays(face_of(own[0])) && stays(face_of(own[1])))) visit(a, b);
        });
    }

private:
    // Why a face stays. Those near the surface and those beside one have no group.
    static constexpr std::uint8_t kNear = 1, kBesideNear = 2, kOfGroup = 4;

    template <class Visit>
    void each_edge_of_face(std::size_t i, const Visit& visit) const {
        const auto loop = model_.face(index(faces_[i]));
        for (std::size_t k = 0; k < loop.size(); ++k)
            visit(loop[k], loop[k + 1 < loop.size() ? k + 1 : 0]);
    }
    Uses uses_of(NodeId a, NodeId b) const {
        const Uses own = uses_[index(std::min(a, b))];
        const auto first = std::ranges::lower_bound(own, std::max(a, b), {}, greater_of);
        return {first, std::ranges::upper_bound(own, std::max(a, b), {}, greater_of)};
    }
    /// Of the uses of an edge: whether faces of one group may be on its two sides.
    bool is_within(Uses own) {
        if (own.size() != 2 || ((own[0] ^ own[1]) & 1) == 0) return false;
        const std::size_t one = face_of(own[0]), other = face_of(own[1]);
        return !has(one, kNear | kBesideNear) && !has(other, kNear | kBesideNear) &&
               model_.cell(index(faces_[one]), 0) == model_.cell(index(faces_[other]), 0) &&
               model_.cell(index(faces_[one]), 1) == model_.cell(index(faces_[other]), 1);
    }
    void note(std::size_t i, std::uint8_t why) {
        if (!has(i, why)) std::atomic_ref(stays_[i]).fetch_or(why, std::memory_order_relaxed);
    }
    bool has(std::size_t i, int why) {
        return (std::atomic_ref(stays_[i]).load(std::memory_order_relaxed) & why) != 0;
    }

    const ComplexView& model_;
    std::span<const std::int32_t> faces_;
    Execution execution_;
    Array<std::uint8_t> stays_;
    DisjointSets joined_;
    Buckets<std::uint64_t> uses_;
};

}  // namespace

FarFaces::FarFaces(const ComplexView& model, std::span<const std::uint8_t> is_near,
                   std::vector<std::int32_t>& faces, const NearestSide& surface, double margin,
                   const Execution& execution)
    : model_(model), is_near_(is_near) {
    const std::size_t count = faces.size();
    Connection connection(model, faces, execution);
    box_ = connection.keep_near(surface, margin);
    connection.join();
    // groups of which any are left out, in the order of their first faces
    auto is_group = zeros<std::uint8_t>(count, execution);
    parallel_each(count, execution, [&](std::size_t i) {
        if (!connection.stays(i)) mark(is_group[connection.first_of_group(i)]);
    });
    Array<std::int32_t> number(count);
    std::fill(number.begin(), number.end(), -1);
    number_in_order(
        count, execution, [&](std::size_t i) { return is_group[i] != 0; },
        [this](std::size_t groups) { first_.resize(groups); },
        [&](std::size_t i, std::size_t group) { number[i] = static_cast<std::int32_t>(group); });
    std::vector<std::int32_t> kept;
    number_in_order(
        count, execution, [&](std::size_t i) { return connection.stays(i); },
        [&](std::size_t size) {
            kept.resize(size);
            group_.resize(size);
        },
        [&](std::size_t i, std::size_t place) {
            kept[place] = faces[i];
            group_[place] = number[connection.first_of_group(i)];
            if (number[i] >= 0) first_[index(number[i])] = static_cast<std::int32_t>(place);
        });
    number_in_order(
        count, execution, [&](std::size_t i) { return !connection.stays(i); },
        [this](std::size_t size) {
            faces_.resize(size);
            groups_of_faces_.resize(size);
        },
        [&](std::size_t i, std::size_t place) {
            faces_[place] = faces[i];
            groups_of_faces_[place] = number[connection.first_of_group(i)];
        });
    of_group_ = bucketize_in_order<std::int32_t>(
        first_.size(), (faces_.size() + kEdgeChunk - 1) / kEdgeChunk,
        [this](std::size_t chunk, const auto& put) {
            const std::size_t end = std::min(faces_.size(), (chunk + 1) * kEdgeChunk);
            for (std::size_t i = chunk * kEdgeChunk; i < end; ++i)
                put(index(groups_of_faces_[i]), faces_[i]);
        },
        execution);
    std::size_t place = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (!connection.stays(i) || group_[place++] < 0) continue;
        connection.each_edge_to_left_out(i, [this](NodeId a, NodeId b) {
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
