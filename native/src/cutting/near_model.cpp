// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/near_model.hpp"

#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>

#include "arrangement/edge_fan.hpp"
#include "base/disjoint_sets.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

using arrangement::EdgeUse;

namespace {

constexpr std::size_t kEdgeChunk = 1 << 12;  // nodes or faces at a time

/// Widens a box around another one while other threads do so, too.
void include_at_once(spatial::Box& box, const spatial::Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        atomic_min_by(box.low[k], other.low[k], std::less<>());
        atomic_min_by(box.high[k], other.high[k], std::greater<>());
    }
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
          joined_(faces.size()),
          edges_(arrangement::edges_of(
              faces.size(), model.vertex_count(),
              [&](std::size_t i) { return model.face(index(faces[i])); }, execution)) {}

    /// Keeps what is near the cutter, and says of what is beside it.
    /// @return around all faces
    spatial::Box keep_near(const NearestSide& nearest, double margin) {
        spatial::Box all;
        parallel_ranges(
            faces_.size(), kEdgeChunk, execution_, [&](std::size_t begin, std::size_t end) {
                spatial::Box around;
                for (std::size_t i = begin; i < end; ++i) {
                    const spatial::Box box = box_of(model_, model_.face(index(faces_[i])));
                    if (nearest.is_near(box, margin) || is_upright(model_, faces_[i], box))
                        stays_[i] = kNear;
                    around.include(box);
                }
                include_at_once(all, around);
            });
        parallel_for_each(faces_.size(), execution_, [&](std::size_t i) {
            if (!has(i, kNear)) return;
            for_each_edge_of(i, [&](const EdgeUse& near_use) {
                for (const EdgeUse& use : edges_.between(near_use.edge))
                    note(index(use.item), kBesideNear);
            });
        });
        return all;
    }

    /// Joins the others across edges that no other faces have, and keeps those with other edges and
    /// the first of each group.
    void join() {
        parallel_for_each(edges_.size(), execution_, [&](std::size_t e) {
            const auto uses = edges_[e];
            if (is_within(uses)) {
                joined_.join(uses[0].item, uses[1].item);
            } else {
                for (const EdgeUse& use : uses)
                    note(index(use.item), kOfGroup);
            }
        });
        parallel_for_each(faces_.size(), execution_, [&](std::size_t i) {
            if (first_of_group(i) == i) note(i, kOfGroup);
        });
    }

    bool stays(std::size_t i) const { return stays_[i] != 0; }
    std::size_t first_of_group(std::size_t i) {
        return index(joined_.find(static_cast<std::int32_t>(i)));
    }
    /// Calls visit(use) for the edges of a face beyond which one of its group does not stay.
    template <class Visit>
    void for_each_edge_to_left_out(std::size_t i, const Visit& visit) {
        for_each_edge_of(i, [&](const EdgeUse& use) {
            const auto uses = edges_.between(use.edge);
            if (is_within(uses) && !(stays(index(uses[0].item)) && stays(index(uses[1].item))))
                visit(use);
        });
    }

private:
    // Why a face stays. Those near the cutter and those beside one have no group.
    static constexpr std::uint8_t kNear = 1, kBesideNear = 2, kOfGroup = 4;

    template <class Visit>
    void for_each_edge_of(std::size_t i, const Visit& visit) const {
        arrangement::for_each_edge(std::array{model_.face(index(faces_[i]))},
                                   static_cast<std::int32_t>(i), visit);
    }
    /// Of the uses of an edge: whether faces of one group may be on its two sides.
    bool is_within(std::span<const EdgeUse> uses) {
        if (uses.size() != 2 || uses[0].direction == uses[1].direction) return false;
        const std::size_t one = index(uses[0].item), other = index(uses[1].item);
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
                   std::vector<std::int32_t>& faces, const NearestSide& nearest, double margin,
                   const Execution& execution)
    : model_(model), is_near_(is_near) {
    const std::size_t count = faces.size();
    Connection connection(model, faces, execution);
    box_ = connection.keep_near(nearest, margin);
    connection.join();
    // groups of which any are left out, in the order of their first faces
    std::vector<std::uint8_t> is_group(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        if (!connection.stays(i)) is_group[connection.first_of_group(i)] = 1;
    }
    std::vector<std::int32_t> number(count, -1), remaining_faces;
    for (std::size_t i = 0; i < count; ++i) {
        poll(execution.progress, i);
        const std::size_t first = connection.first_of_group(i);
        if (!connection.stays(i)) {
            faces_.push_back(faces[i]);
            groups_of_faces_.push_back(number[first]);
            continue;
        }
        if (is_group[i] != 0) {
            number[i] = static_cast<std::int32_t>(first_.size());
            first_.push_back(static_cast<std::int32_t>(remaining_faces.size()));
        }
        remaining_faces.push_back(faces[i]);
        group_.push_back(number[first]);
        if (number[first] < 0) continue;
        connection.for_each_edge_to_left_out(
            i, [this](const EdgeUse& use) { edges_.push_back(use.key()); });
    }
    of_group_ = bucketize<std::int32_t>(first_.size(), [this](const auto& put) {
        for (std::size_t i = 0; i < faces_.size(); ++i)
            put(index(groups_of_faces_[i]), faces_[i]);
    });
    std::ranges::sort(edges_);
    faces = std::move(remaining_faces);
}

void FarFaces::renumber(std::span<const NodeId> number) {
    for (std::uint64_t& edge : edges_) {
        const auto [a, b] = unpacked_pair(edge);
        edge = packed_pair(number[index(a)], number[index(b)]);
    }
}

double margin_of(const CellBoxes& cells, const NearestSide& nearest) {
    return 16 * std::max(rounding_of(nearest.cutter().vertices), cells.rounding);
}

CellBoxes::CellBoxes(const ComplexView& model, std::span<const NearestSide> nearest_sides,
                     const Execution& execution)
    : boxes(model.cell_count()) {
    constexpr std::size_t kChunk = 1 << 14;
    const std::size_t vertices = model.vertex_count();
    std::vector<double> largest((vertices + kChunk - 1) / kChunk, 0);
    parallel_ranges(vertices, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        double& chunk_largest = largest[begin / kChunk];
        for (std::size_t i = 3 * begin; i < 3 * end; ++i)
            chunk_largest = std::max(chunk_largest, std::abs(model.vertices[i]));
    });
    if (!largest.empty()) rounding = 4 * kComputedUlps * ulp(std::ranges::max(largest));
    spatial::Box around;
    for (const NearestSide& nearest : nearest_sides) {
        spatial::Box box = spatial::bounding_box(nearest.cutter().vertices);
        box.widen(4 * margin_of(*this, nearest));
        around.include(box);
    }
    // of vertices and cells: a bit for each side of that box that something of them is within
    std::vector<std::uint8_t> within(vertices), of_cell(model.cell_count(), 0);
    parallel_ranges(vertices, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            unsigned bits = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double x = model.vertices[3 * v + k];
                bits |= (x >= around.low[k] ? 1U : 0U) << (2 * k);
                bits |= (x <= around.high[k] ? 2U : 0U) << (2 * k);
            }
            within[v] = static_cast<std::uint8_t>(bits);
        }
    });
    parallel_ranges(model.face_count(), kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            std::uint8_t bits = 0;
            for (const NodeId v : model.face(f))
                bits |= within[index(v)];
            for (std::size_t k = 0; k < 2; ++k) {
                if (model.cell(f, k) < 0) continue;
                const std::atomic_ref cell_bits(of_cell[index(model.cell(f, k))]);
                if ((cell_bits.load(std::memory_order_relaxed) | bits) !=
                    cell_bits.load(std::memory_order_relaxed))
                    cell_bits.fetch_or(bits, std::memory_order_relaxed);
            }
        }
    });
    constexpr std::uint8_t kAll = 63;
    parallel_ranges(model.face_count(), kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            spatial::Box box;
            for (std::size_t k = 0; k < 2; ++k) {
                const std::int32_t cell = model.cell(f, k);
                if (cell < 0 || of_cell[index(cell)] != kAll) continue;
                if (box.low[0] > box.high[0]) {
                    for (const NodeId v : model.face(f))
                        box.include(model.vertex(v));
                }
                include_at_once(boxes[index(cell)], box);
            }
        }
    });
}

std::vector<std::uint8_t> cells_near(const CellBoxes& cells, const NearestSide& nearest,
                                     const Execution& execution) {
    const double margin = margin_of(cells, nearest);
    std::vector<std::uint8_t> is_near(cells.boxes.size(), 0);
    parallel_ranges(is_near.size(), 1 << 12, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            is_near[c] = nearest.is_near(cells.boxes[c], margin) ? 1 : 0;
    });
    return is_near;
}

std::vector<std::int8_t> sides_of_far_cells(const ComplexView& model, const NearestSide& nearest,
                                            std::span<const std::uint8_t> is_near,
                                            const Execution& execution) {
    constexpr std::size_t kChunk = 1 << 15;
    DisjointSets joined(model.cell_count());
    const auto is_far = [&](std::int32_t c) { return c >= 0 && is_near[index(c)] == 0; };
    parallel_ranges(model.face_count(), kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (is_far(model.cell(f, 0)) && is_far(model.cell(f, 1)))
                joined.join(model.cell(f, 0), model.cell(f, 1));
        }
    });
    std::vector<std::int8_t> sides(model.cell_count(), kOn);
    // of the first cell of what is connected: its last face, whose first vertex stands for it
    std::vector<std::int32_t> face(model.cell_count(), -1);
    const auto is_first = [&](std::int32_t c) { return is_far(c) && joined.find(c) == c; };
    parallel_ranges(model.face_count(), kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            for (std::size_t k = 0; k < 2; ++k) {
                const std::int32_t c = model.cell(f, k);
                if (is_first(c))
                    atomic_min_by(face[index(c)], static_cast<std::int32_t>(f), std::greater<>());
            }
        }
    });
    for (std::int32_t c = 0; index(c) < sides.size(); ++c) {
        if (!is_far(c)) continue;
        if (joined.find(c) != c) {
            sides[index(c)] = sides[index(joined.find(c))];
        } else if (face[index(c)] >= 0) {
            sides[index(c)] = nearest.side(model.vertex(model.face(index(face[index(c)]))[0]));
        }
    }
    return sides;
}

NearModel::NearModel(const ComplexView& model, std::span<const std::uint8_t> is_near,
                     const Execution& execution, const NearestSide* nearest, double margin)
    : model_(model), number_(model.cell_count(), -1) {
    for (std::int32_t c = 0; index(c) < number_.size(); ++c) {
        if (is_near[index(c)] == 0) continue;
        number_[index(c)] = static_cast<std::int32_t>(cells_.size());
        cells_.push_back(c);
        complex_.cell_block.push_back(model.cell_block[index(c)]);
    }
    const auto is_asked = [&](std::int32_t cell) { return cell >= 0 && is_near[index(cell)] != 0; };
    number_in_order(
        model.face_count(), execution,
        [&](std::size_t f) { return is_asked(model.cell(f, 0)) || is_asked(model.cell(f, 1)); },
        [this](std::size_t count) { faces_.resize(count); },
        [this](std::size_t f, std::size_t i) { faces_[i] = static_cast<std::int32_t>(f); });
    if (nearest != nullptr && model.cell_kind == CellKind::kBlocks)
        far_ = FarFaces(model, is_near, faces_, *nearest, margin, execution);
    // in the model's order: what is decided by numbers does not depend on which faces come first
    auto is_here = zeros<std::uint8_t>(model.vertex_count(), execution);
    parallel_for_each(faces_.size(), execution, [&](std::size_t i) {
        for (const NodeId v : model.face(index(faces_[i])))
            atomic_set(is_here[index(v)]);
    });
    Array<NodeId> near_vertex(model.vertex_count());
    number_in_order(
        is_here.size(), execution, [&](std::size_t v) { return is_here[v] != 0; },
        [this](std::size_t count) {
            complex_.vertices.resize(count);
            vertices_of_.resize(count);
        },
        [&](std::size_t v, std::size_t number) {
            const auto node = static_cast<NodeId>(v);
            near_vertex[v] = static_cast<NodeId>(number);
            complex_.vertices[number] = model.vertex(node);
            vertices_of_[number] = node;
        });
    far_.renumber(near_vertex);
    complex_.face_offsets.push_back(0);
    for (const std::int32_t face : faces_) {
        const auto f = index(face);
        std::array<std::int32_t, 2> cells{-1, -1};
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) cells[k] = number_[index(model.cell(f, k))];
        }
        assert(cells[0] >= 0 || cells[1] >= 0);
        const auto corners = model.face(f);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const NodeId v = corners[cells[0] >= 0 ? i : corners.size() - 1 - i];
            complex_.face_vertices.push_back(near_vertex[index(v)]);
        }
        complex_.face_offsets.push_back(static_cast<std::int64_t>(complex_.face_vertices.size()));
        complex_.face_cells.push_back(cells[0] >= 0 ? cells : std::array{cells[1], -1});
        complex_.face_surface.push_back(model.face_surface[f]);
        beyond_.push_back(cells[0] < 0 ? model.cell(f, 0) : cells[1] < 0 ? model.cell(f, 1) : -1);
    }
}

ComplexView NearModel::view() const {
    ComplexView view = complex_;
    view.blocks = model_.blocks;
    view.surfaces = model_.surfaces;
    view.cell_kind = model_.cell_kind;
    return view;
}

/// Puts the parts of near cells and the other cells in the model's order.
/// @return the new number of each part
std::vector<std::int32_t> NearModel::number_parts(std::vector<HalfCell>& half_cells,
                                                  WholePieces& whole) const {
    const std::vector<HalfCell> parts = std::move(half_cells);
    std::vector<std::int32_t> order(parts.size()), number(parts.size());
    std::iota(order.begin(), order.end(), 0);
    const auto cell_of = [&](std::int32_t part) { return cells_[index(parts[index(part)].cell)]; };
    std::ranges::stable_sort(order, {}, cell_of);
    whole.far_part_.assign(number_.size(), -1);
    half_cells.clear();
    auto next = order.begin();
    for (std::int32_t c = 0; index(c) < number_.size(); ++c) {
        for (; next != order.end() && cell_of(*next) == c; ++next) {
            number[index(*next)] = checked_number(half_cells.size(), "parts of cells");
            half_cells.push_back(parts[index(*next)]);
            half_cells.back().cell = c;
        }
        if (number_[index(c)] >= 0) {
            whole.far_part_[index(c)] = WholePieces::kNear;
        } else if (whole.sides_[index(c)] != kOn) {
            whole.far_part_[index(c)] = checked_number(half_cells.size(), "parts of cells");
            half_cells.push_back({c, whole.sides_[index(c)]});
        }
    }
    if (next != order.end()) throw InternalError("each part is of a cell of the model");
    return number;
}

std::optional<WholePieces> NearModel::put_back(CutPieces&& pieces,
                                               std::vector<HalfCell>& half_cells,
                                               std::span<const std::int8_t> sides) const {
    WholePieces whole;
    whole.model_ = model_;
    whole.far_ = &far_;
    whole.of_groups_.resize(far_.groups());
    std::size_t first_faces = 0;
    whole.sides_ = sides;
    const std::vector<std::int32_t> number = number_parts(half_cells, whole);
    // pieces in the order of the model's faces, then cut faces
    const CutPieces near = std::move(pieces);
    std::vector<std::int32_t> of_faces(near.size());
    std::iota(of_faces.begin(), of_faces.end(), 0);
    const auto key = [&](std::int32_t p) {
        const std::int32_t face = near[index(p)].face;
        return face < 0 ? INT32_MAX : face;
    };
    std::ranges::stable_sort(of_faces, {}, key);
    auto beside = std::ranges::count_if(
        beyond_, [&](std::int32_t cell) { return cell >= 0 && whole.far_part_[index(cell)] >= 0; });
    const auto near_vertices = static_cast<NodeId>(complex_.vertices.size());
    const auto all = static_cast<NodeId>(model_.vertex_count());
    whole.near_.origins.reserve(near.size());
    whole.near_.polygons.nodes.reserve(near.polygons.nodes.size());
    whole.near_.polygons.offsets.reserve(near.size() + 1);
    for (const std::int32_t p : of_faces) {
        const auto polygon = near.polygons[index(p)];
        CutPiece piece = near[index(p)];
        for (std::int32_t& part : piece.parts) {
            if (part >= 0) part = number[index(part)];
        }
        for (std::int32_t& cell : piece.cells) {
            if (cell >= 0) cell = cells_[index(cell)];
        }
        if (piece.face >= 0) {
            const auto face = index(piece.face);
            const bool is_first = far_.is_first(face);
            if (is_first && (!std::ranges::equal(polygon, view().face(face)) ||
                             (piece.cells[0] >= 0) != (piece.parts[0] >= 0) ||
                             (piece.cells[1] >= 0) != (piece.parts[1] >= 0)))
                return std::nullopt;
            piece.face = faces_[face];
            if (const std::int32_t beyond = beyond_[face]; beyond >= 0) {
                piece.cells[1] = beyond;
                if (whole.far_part_[index(beyond)] >= 0) {
                    if (piece.parts[1] >= 0 || !std::ranges::equal(polygon, view().face(face)))
                        return std::nullopt;
                    piece.parts[1] = whole.far_part_[index(beyond)];
                    piece.sides[1] = sides[index(beyond)];
                    --beside;
                }
            }
            if (is_first) {
                whole.of_groups_[index(far_.group(face))] = piece;
                ++first_faces;
            }
        }
        for (const NodeId node : polygon) {
            whole.near_.polygons.nodes.push_back(node < near_vertices ? vertices_of_[index(node)]
                                                                      : node - near_vertices + all);
        }
        whole.near_.polygons.close();
        whole.near_.origins.push_back(piece);
    }
    if (beside != 0 || first_faces != far_.groups()) return std::nullopt;
    whole.first_cut_face_ = index(std::ranges::count_if(
        whole.near_.origins, [](const CutPiece& piece) { return piece.face >= 0; }));
    return whole;
}

}  // namespace realmodel::cutting
