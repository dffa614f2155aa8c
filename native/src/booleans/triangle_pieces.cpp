// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/triangle_pieces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/parallel.hpp"

namespace realmodel::booleans {

namespace {

constexpr std::size_t kMany = 1 << 6;  ///< so many pieces of one triangle are found by a tree

void check(const TriangleView& mesh, int surface) {
    if (mesh.triangle_count() == 0)
        throw InputError("no_triangles", "the surface has no triangles", surface);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!std::isfinite(mesh.vertices[i]))
            throw InputError("not_finite", "a coordinate is not finite", surface,
                             {static_cast<std::int64_t>(i / 3)});
    }
    require_triangles(mesh.triangles, mesh.vertices.size() / 3, surface);
}

exact::SpacePosition position(const TriangleView& mesh, std::size_t vertex) {
    return {mesh.vertices[3 * vertex], mesh.vertices[3 * vertex + 1],
            mesh.vertices[3 * vertex + 2]};
}

}  // namespace

TrianglePieces::TrianglePieces(const std::array<TriangleView, 2>& surfaces,
                               const Execution& execution)
    : progress_(execution.progress), second_(surfaces[0].triangle_count()) {
    for (std::uint8_t source = 0; source < 2; ++source)
        check(surfaces[source], source);
    checked_number(second_ + surfaces[1].triangle_count(), "triangles");
    parallel_tasks(2, execution, 0.02, [&](std::size_t task, const Execution& task_execution) {
        if (task == 0) {
            add_triangles(surfaces, task_execution.progress);
        } else {
            make_tree(surfaces, task_execution);
        }
    });
    count_ = whole_.size();
    list_.assign(whole_.size(), -1);
}

void TrianglePieces::add_triangles(const std::array<TriangleView, 2>& surfaces,
                                   Progress* progress) {
    points.reserve((surfaces[0].vertices.size() + surfaces[1].vertices.size()) / 3);
    whole_.reserve(second_ + surfaces[1].triangle_count());
    for (const TriangleView& mesh : surfaces) {
        std::vector<SpacePointId> number(mesh.vertices.size() / 3, kNone);
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
            poll(progress, t);
            TrianglePiece piece;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t v = index(mesh.triangles[3 * t + k]);
                if (!number[v].has_value()) number[v] = points.add(position(mesh, v));
                piece.corners[k] = number[v];
            }
            piece.is_fresh = true;
            whole_.push_back(piece);
        }
    }
    for (std::size_t v = 0; v < points.size(); ++v) {
        for (const double x : points.rounded(SpacePointId(v)))
            largest_ = std::max(largest_, std::abs(x));
    }
}

void TrianglePieces::make_tree(const std::array<TriangleView, 2>& surfaces,
                               const Execution& execution) {
    std::vector<spatial::Box> boxes(second_ + surfaces[1].triangle_count());
    parallel_for_each(boxes.size(), execution, [&](std::size_t i) {
        const TriangleView& mesh = surfaces[i < second_ ? 0 : 1];
        const std::size_t t = i < second_ ? i : i - second_;
        for (std::size_t k = 0; k < 3; ++k)
            boxes[i].include(position(mesh, index(mesh.triangles[3 * t + k])));
    });
    tree_ = std::make_unique<spatial::BoxTree>(std::move(boxes), execution);
}

void TrianglePieces::replace(std::int32_t input, std::vector<TrianglePiece>&& pieces) {
    assert(std::ranges::none_of(
        pieces, [](const TrianglePiece& p) { return has_equal_corners(p.corners); }));
    count_ += pieces.size();
    count_ -= of(input).size();
    std::int32_t& number = list_[index(input)];
    if (number < 0) {
        number = static_cast<std::int32_t>(lists_.size());
        lists_.emplace_back();
    }
    PieceList& list = lists_[index(number)];
    list.pieces = std::move(pieces);
    list.tree.reset();
    if (list.pieces.size() < kMany) return;
    auto boxes = transformed(list.pieces, [this](const auto& piece) { return box(piece.corners); });
    list.tree = std::make_unique<spatial::BoxTree>(std::move(boxes), Execution{1, progress_});
}

}  // namespace realmodel::booleans
