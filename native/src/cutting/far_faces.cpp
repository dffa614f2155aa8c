// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/far_faces.hpp"

#include <array>
#include <atomic>

#include "arrangement/edge_fan.hpp"
#include "base/disjoint_sets.hpp"
#include "base/packed_pair.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "cutting/near_part.hpp"

namespace realmodel::cutting {

using arrangement::EdgeUse;

namespace {

constexpr std::size_t kEdgeChunk = 1 << 12;  // nodes or faces at a time

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
          joined_(faces.size()),
          edges_(arrangement::edges_of(
              faces.size(), model.vertex_count(),
              [&](std::size_t i) { return model.face(index(faces[i])); }, execution)) {}

    /// Keeps what is near the surface, and says of what is beside it.
    /// @return around all faces
    spatial::Box keep_near(const NearestSide& surface, double margin) {
        spatial::Box all;
        parallel_ranges(
            faces_.size(), kEdgeChunk, execution_, [&](std::size_t begin, std::size_t end) {
                spatial::Box around;
                for (std::size_t i = begin; i < end; ++i) {
                    const spatial::Box box = box_of(model_, model_.face(index(faces_[i])));
                    if (surface.is_near(box, margin) || is_upright(model_, faces_[i], box))
                        stays_[i] = kNear;
                    around.include(box);
                }
                include_at_once(all, around);
            });
        parallel_each(faces_.size(), execution_, [&](std::size_t i) {
            if (!has(i, kNear)) return;
            each_edge_of(i, [&](const EdgeUse& own) {
                for (const EdgeUse& use : edges_.between(own.edge))
                    note(index(use.item), kBesideNear);
            });
        });
        return all;
    }

    /// Joins the others across edges that no other faces have, and keeps those with other edges and
    /// the first of each group.
    void join() {
        parallel_each(edges_.size(), execution_, [&](std::size_t e) {
            const auto own = edges_[e];
            if (is_within(own)) {
                joined_.join(own[0].item, own[1].item);
            } else {
                for (const EdgeUse& use : own)
                    note(index(use.item), kOfGroup);
            }
        });
        parallel_each(faces_.size(), execution_, [&](std::size_t i) {
            if (first_of_group(i) == i) note(i, kOfGroup);
        });
    }

    bool stays(std::size_t i) const { return stays_[i] != 0; }
    std::size_t first_of_group(std::size_t i) {
        return index(joined_.find(static_cast<std::int32_t>(i)));
    }
    /// Calls visit(use) for the edges of a face beyond which one of its group does not stay.
    template <class Visit>
    void each_edge_to_left_out(std::size_t i, const Visit& visit) {
        each_edge_of(i, [&](const EdgeUse& use) {
            const auto own = edges_.between(use.edge);
            if (is_within(own) && !(stays(index(own[0].item)) && stays(index(own[1].item))))
                visit(use);
        });
    }

private:
    // Why a face stays. Those near the surface and those beside one have no group.
    static constexpr std::uint8_t kNear = 1, kBesideNear = 2, kOfGroup = 4;

    template <class Visit>
    void each_edge_of(std::size_t i, const Visit& visit) const {
        arrangement::each_edge(std::array{model_.face(index(faces_[i]))},
                               static_cast<std::int32_t>(i), visit);
    }
    /// Of the uses of an edge: whether faces of one group may be on its two sides.
    bool is_within(std::span<const EdgeUse> own) {
        if (own.size() != 2 || own[0].direction == own[1].direction) return false;
        const std::size_t one = index(own[0].item), other = index(own[1].item);
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
    arrangement::EdgeUses edges_;
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
        connection.each_edge_to_left_out(
            i, [this](const EdgeUse& use) { edges_.push_back(use.key()); });
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
