// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/simulation/clean_cells.hpp"
#include "simulation/cleaning/list_pool.hpp"

namespace realmodel::simulation {

inline bool contains(std::span<const std::int32_t> numbers, std::int32_t number) {
    return std::ranges::find(numbers, number) != numbers.end();
}

/// The corners after and before one in a loop; nothing where it has no such corner.
inline std::optional<std::array<std::int32_t, 2>> beside(std::span<const std::int32_t> loop,
                                                         std::int32_t corner) {
    const auto at = static_cast<std::size_t>(std::ranges::find(loop, corner) - loop.begin());
    const std::size_t n = loop.size();
    if (at == n) return std::nullopt;
    return std::array{loop[(at + 1) % n], loop[(at + n - 1) % n]};
}

/// The area vector of a face, away from its first cell, and its center, as OpenFOAM has them: of
/// the triangles between its edges and the mean of its corners.
struct FaceVectors {
    Vec3 area{}, center{};
};

struct CellShape {
    double volume = 0;
    double area = 0;       ///< of all its faces
    int turned_faces = 0;  ///< from whose inner side the cell's center is not seen
};

/// A face and the side from which a cell has it.
struct SeenFace {
    FaceVectors shape;
    double sign;
};

CellShape cell_shape(std::span<const SeenFace> faces);

/// Faces that replace others. Vertices stay where they are: a change joins them, or brings one into
/// an edge, so it is wholly in the corners of faces and in the cells beside them.
struct Change {
    struct Face {
        std::int32_t origin;  ///< the face that it was
        std::uint32_t begin, size;
        std::array<std::int32_t, 2> cells;
        std::int32_t surface;
        bool is_joined;  ///< of two faces
        FaceVectors shape;
    };
    std::vector<std::int32_t> removed;
    std::vector<Face> added;
    std::vector<std::int32_t> corners;
    /// Cells (-1: the outside) whose faces may meet in other ways than before.
    std::vector<std::int32_t> tested;

    void clear();
    std::span<const std::int32_t> loop(const Face& face) const {
        return std::span(corners).subspan(face.begin, face.size);
    }
    /// Adds the parts of a loop, divided where it meets itself in a vertex; parts of fewer than
    /// three corners vanish.
    void add(std::span<const std::int32_t> loop, std::int32_t origin,
             std::array<std::int32_t, 2> cells, std::int32_t surface);

private:
    void add_simple(std::span<const std::int32_t> loop, std::int32_t origin,
                    std::array<std::int32_t, 2> cells, std::int32_t surface);
    std::vector<std::int32_t> open_;  // of add(): the part that is not divided off yet
};

/// A complex whose faces can be replaced, with the faces of each cell and vertex.
class EditableComplex {
public:
    EditableComplex(const ComplexView& model, const Execution& execution);

    std::span<const std::int32_t> corners(std::int32_t face) const { return corners_[face]; }
    std::span<const std::int32_t> cell_faces(std::int32_t cell) const { return cell_faces_[cell]; }
    std::span<const std::int32_t> vertex_faces(std::int32_t v) const { return vertex_faces_[v]; }
    const std::array<std::int32_t, 2>& cells(std::int32_t face) const {
        return cells_[index(face)];
    }
    std::int32_t surface(std::int32_t face) const { return surface_[index(face)]; }
    const FaceVectors& shape(std::int32_t face) const { return shapes_[index(face)]; }
    const CellShape& cell(std::int32_t cell) const { return cell_shapes_[index(cell)]; }
    /// Relative to the middle of the model.
    Vec3 point(std::int32_t v) const { return points_[index(v)]; }
    double distance(std::int32_t u, std::int32_t v) const {
        return length(minus(point(u), point(v)));
    }
    std::int32_t block(std::int32_t cell) const { return model_.cell_block[index(cell)]; }
    bool has_face(std::int32_t face) const { return !corners(face).empty(); }
    bool has_cell(std::int32_t cell) const { return !cell_faces(cell).empty(); }
    std::int32_t face_count() const { return static_cast<std::int32_t>(corners_.size()); }
    std::int32_t cell_count() const { return static_cast<std::int32_t>(cell_faces_.size()); }
    std::int32_t vertex_count() const { return static_cast<std::int32_t>(points_.size()); }

    FaceVectors shape_of(std::span<const std::int32_t> loop) const;
    /// The cell as it is.
    CellShape measured(std::int32_t cell) const;

    void apply(const Change& change);

    ComplexCounts counts() const;
    std::vector<double> block_volumes() const;
    /// What is left, without vertices that no face has.
    CleanedCells taken() const;

private:
    void remove(std::int32_t face);
    bool is_closed(std::int32_t cell) const;

    ComplexView model_;
    std::vector<Vec3> points_;
    std::vector<std::array<std::int32_t, 2>> cells_;
    std::vector<std::int32_t> surface_;
    std::vector<FaceVectors> shapes_;
    std::vector<CellShape> cell_shapes_;
    ListPool corners_, cell_faces_, vertex_faces_;
};

}  // namespace realmodel::simulation
