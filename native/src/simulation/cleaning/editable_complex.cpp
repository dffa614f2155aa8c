// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/cleaning/editable_complex.hpp"

#include <algorithm>
#include <cassert>
#include <map>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::size_t kAtOnce = 1 << 13;

void check_indices(const ComplexView& model) {
    const std::size_t faces = model.face_count();
    if (model.face_offsets.size() != faces + 1 || model.face_surface.size() != faces)
        refuse_index("face", faces, "has no offset, or one too many");
    for (std::size_t f = 0; f < faces; ++f) {
        require_vertices("face", f,
                         checked_corners("face", f, model.face_offsets, model.face_vertices, 1),
                         model.vertex_count());
        require_cells(f, {model.cell(f, 0), model.cell(f, 1)}, model.cell_count());
        if (model.cell(f, 0) < 0) refuse_index("face", f, "has no first cell");
    }
    for (const std::int32_t block : model.cell_block) {
        if (block < 0 || index(block) >= model.blocks)
            refuse_index("face", 0, "has a cell of no block");
    }
}

std::vector<std::int32_t> copy_of(std::span<const std::int32_t> numbers) {
    return {numbers.begin(), numbers.end()};
}

/// Lists of the faces that have each of `count` things; visit(face, see) calls see(thing).
template <class Visit>
ListPool faces_of(std::size_t count, std::size_t faces, const Visit& visit) {
    const auto lists = bucketize<std::int32_t>(count, [&](const auto& put) {
        for (std::size_t f = 0; f < faces; ++f)
            visit(f, [&](std::int32_t thing) { put(index(thing), static_cast<std::int32_t>(f)); });
    });
    return {std::span<const std::uint32_t>(lists.offsets), copy_of(lists.values)};
}

}  // namespace

CellShape cell_shape(std::span<const SeenFace> faces) {
    CellShape shape;
    Vec3 middle{};
    for (const SeenFace& face : faces)
        middle = plus(middle, face.shape.center);
    middle = times(1.0 / static_cast<double>(faces.size()), middle);
    Vec3 moment{};
    for (const SeenFace& face : faces) {
        const Vec3 arm = minus(face.shape.center, middle);
        const double term = face.sign * dot(face.shape.area, arm) / 3;
        shape.volume += term;
        moment = moved(moment, term, times(0.75, arm));
        shape.area += length(face.shape.area);
    }
    const Vec3 center = shape.volume > 0 ? moved(middle, 1 / shape.volume, moment) : middle;
    for (const SeenFace& face : faces) {
        if (!(face.sign * dot(face.shape.area, minus(face.shape.center, center)) > 0))
            ++shape.turned_faces;
    }
    return shape;
}

void Change::clear() {
    removed.clear();
    added.clear();
    corners.clear();
    tested.clear();
}

void Change::add_simple(std::span<const std::int32_t> loop, std::int32_t origin,
                        std::array<std::int32_t, 2> cells, std::int32_t surface) {
    if (loop.size() < 3) return;
    added.push_back({origin,
                     static_cast<std::uint32_t>(corners.size()),
                     static_cast<std::uint32_t>(loop.size()),
                     cells,
                     surface,
                     false,
                     {}});
    corners.insert(corners.end(), loop.begin(), loop.end());
}

void Change::add(std::span<const std::int32_t> loop, std::int32_t origin,
                 std::array<std::int32_t, 2> cells, std::int32_t surface) {
    open_.clear();
    for (const std::int32_t v : loop) {
        const auto met = std::find(open_.begin(), open_.end(), v);
        if (met != open_.end()) {
            add_simple({met, open_.end()}, origin, cells, surface);
            open_.erase(met, open_.end());
        }
        open_.push_back(v);
    }
    add_simple(open_, origin, cells, surface);
}

EditableComplex::EditableComplex(const ComplexView& model, const Execution& execution)
    : model_((check_indices(model), model)),
      cells_(model.face_count()),
      surface_(copy_of(model.face_surface)),
      shapes_(model.face_count()),
      cell_shapes_(model.cell_count()),
      corners_(model.face_offsets, copy_of(model.face_vertices)),
      cell_faces_(faces_of(model.cell_count(), model.face_count(),
                           [&](std::size_t f, const auto& see) {
                               see(model.cell(f, 0));
                               if (model.cell(f, 1) >= 0) see(model.cell(f, 1));
                           })),
      vertex_faces_(
          faces_of(model.vertex_count(), model.face_count(), [&](std::size_t f, const auto& see) {
              for (const std::int32_t v : model.face(f))
                  see(v);
          })) {
    spatial::Box box;
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        box.include(model.vertex(static_cast<std::int32_t>(v)));
    const Vec3 ends = plus(box.low, box.high), middle{ends[0] / 2, ends[1] / 2, ends[2] / 2};
    points_.reserve(model.vertex_count());
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        points_.push_back(minus(model.vertex(static_cast<std::int32_t>(v)), middle));
    for (std::size_t f = 0; f < cells_.size(); ++f)
        cells_[f] = {model.cell(f, 0), model.cell(f, 1)};
    parallel_ranges(cells_.size(), kAtOnce, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
            shapes_[f] = shape_of(corners(static_cast<std::int32_t>(f)));
    });
    parallel_ranges(cell_shapes_.size(), kAtOnce, execution,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c)
                            cell_shapes_[c] = measured(static_cast<std::int32_t>(c));
                    });
}

FaceVectors EditableComplex::shape_of(std::span<const std::int32_t> loop) const {
    Vec3 middle{};
    for (const std::int32_t v : loop)
        middle = plus(middle, point(v));
    middle = times(1.0 / static_cast<double>(loop.size()), middle);
    FaceVectors vectors;
    Vec3 moment{};
    double weights = 0;
    Vec3 from = minus(point(loop.back()), middle);
    for (const std::int32_t v : loop) {
        const Vec3 to = minus(point(v), middle);
        const Vec3 term = times(0.5, cross(from, to));
        const double weight = length(term);
        vectors.area = plus(vectors.area, term);
        moment = moved(moment, weight, plus(from, to));
        weights += weight;
        from = to;
    }
    vectors.center = weights > 0 ? moved(middle, 1 / (3 * weights), moment) : middle;
    return vectors;
}

/// Whether the faces of a cell use each of its edges as often one way as the other.
[[maybe_unused]] bool EditableComplex::is_closed(std::int32_t cell) const {
    std::map<std::array<std::int32_t, 2>, int> uses;
    for (const std::int32_t f : cell_faces(cell)) {
        std::int32_t from = corners(f).back();
        for (const std::int32_t to : corners(f)) {
            uses[unordered(from, to)] += (from < to) == (cells(f)[0] == cell) ? 1 : -1;
            from = to;
        }
    }
    return std::ranges::all_of(uses, [](const auto& edge) { return edge.second == 0; });
}

CellShape EditableComplex::measured(std::int32_t cell) const {
    std::vector<SeenFace> seen;
    for (const std::int32_t f : cell_faces(cell))
        seen.push_back({shape(f), cells(f)[0] == cell ? 1.0 : -1.0});
    return seen.empty() ? CellShape{} : cell_shape(seen);
}

void EditableComplex::remove(std::int32_t face) {
    for (const std::int32_t v : corners(face))
        vertex_faces_.erase(v, face);
    for (const std::int32_t c : cells(face)) {
        if (c >= 0) cell_faces_.erase(c, face);
    }
    corners_.set(face, {});
}

void EditableComplex::apply(const Change& change) {
    std::vector<std::int32_t> touched;
    const auto touch = [&](const std::array<std::int32_t, 2>& beside) {
        for (const std::int32_t c : beside) {
            if (c >= 0) touched.push_back(c);
        }
    };
    for (const std::int32_t f : change.removed) {
        assert(has_face(f));
        touch(cells(f));
        remove(f);
    }
    for (const Change::AddedFace& face : change.added) {
        std::int32_t f = face.origin;
        if (has_face(f)) {
            f = corners_.add_list();
            cells_.emplace_back();
            surface_.emplace_back();
            shapes_.emplace_back();
        }
        corners_.set(f, change.loop(face));
        cells_[index(f)] = face.cells;
        surface_[index(f)] = face.surface;
        shapes_[index(f)] = face.shape;
        for (const std::int32_t v : corners(f))
            vertex_faces_.push(v, f);
        for (const std::int32_t c : face.cells) {
            if (c >= 0) cell_faces_.push(c, f);
        }
        touch(face.cells);
    }
    sort_unique(touched);
    for (const std::int32_t c : touched) {
        cell_shapes_[index(c)] = measured(c);
        assert(!has_cell(c) || is_closed(c));
    }
}

ComplexCounts EditableComplex::counts() const {
    ComplexCounts counts;
    for (std::int32_t f = 0; f < face_count(); ++f)
        counts.faces += has_face(f);
    for (std::int32_t c = 0; c < cell_count(); ++c)
        counts.cells += has_cell(c);
    std::vector<std::int32_t> ends;
    for (std::int32_t v = 0; v < vertex_count(); ++v) {
        ends.clear();
        for (const std::int32_t f : vertex_faces(v)) {
            const auto near = beside(corners(f), v);
            assert(near.has_value());
            for (const std::int32_t w : *near) {
                if (w > v) ends.push_back(w);
            }
        }
        sort_unique(ends);
        counts.edges += ends.size();
    }
    return counts;
}

std::vector<double> EditableComplex::block_volumes() const {
    std::vector<double> volumes(model_.blocks, 0.0);
    for (std::int32_t c = 0; c < cell_count(); ++c) {
        if (has_cell(c)) volumes[index(block(c))] += cell(c).volume;
    }
    return volumes;
}

CleanedCells EditableComplex::taken() const {
    CleanedCells made;
    CellComplex& out = made.complex;
    out.cell_kind = model_.cell_kind;
    std::vector<std::int32_t> vertex(points_.size(), -1), cell(cell_faces_.size(), -1);
    for (std::int32_t v = 0; v < vertex_count(); ++v) {
        if (vertex_faces(v).empty()) continue;
        vertex[index(v)] = static_cast<std::int32_t>(out.vertices.size());
        out.vertices.push_back(model_.vertex(v));
    }
    for (std::int32_t c = 0; c < cell_count(); ++c) {
        if (!has_cell(c)) continue;
        cell[index(c)] = static_cast<std::int32_t>(out.cell_block.size());
        out.cell_block.push_back(block(c));
        made.cell_origin.push_back(c);
    }
    out.face_offsets.push_back(0);
    for (std::int32_t f = 0; f < face_count(); ++f) {
        if (!has_face(f)) continue;
        for (const std::int32_t v : corners(f))
            out.face_vertices.push_back(vertex[index(v)]);
        out.face_offsets.push_back(static_cast<std::int64_t>(out.face_vertices.size()));
        const auto [first, second] = cells(f);
        out.face_cells.push_back({cell[index(first)], second < 0 ? -1 : cell[index(second)]});
        out.face_surface.push_back(surface(f));
    }
    out.volumes = block_volumes();
    return made;
}

}  // namespace realmodel::simulation
