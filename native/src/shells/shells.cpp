// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/shells/shells.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>
#include <utility>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::shells {

namespace {

using Position = std::array<double, 3>;

/// A face of the complex as one side sees it.
struct OrientedFace {
    std::int32_t face;
    std::int32_t cell;
    bool reversed;  ///< the cell is the face's second
};

void require_in_range(const ComplexView& complex, Progress* progress) {
    const std::size_t faces = complex.face_count();
    if (complex.face_offsets.size() != faces + 1)
        refuse_index("face", faces, "has no offset, or one too many");
    for (std::size_t f = 0; f < faces; ++f) {
        poll(progress, f);
        const auto corners =
            checked_corners("face", f, complex.face_offsets, complex.face_vertices, 0);
        require_vertices("face", f, corners, complex.vertex_count());
        require_cells(f, {complex.cell(f, 0), complex.cell(f, 1)}, complex.cell_count());
    }
    for (const std::int32_t block : complex.cell_block) {
        if (block < 0 || std::cmp_greater_equal(block, complex.blocks))
            throw InputError("bad_index", "a cell refers to a block that does not exist", -1, {});
    }
}

/// The sides of all faces by the block of their cell, in the order of the faces.
/// @param between_blocks  leave out faces that have one block on both sides
std::vector<std::vector<OrientedFace>> faces_by_block(const ComplexView& complex,
                                                      bool between_blocks, Progress* progress) {
    std::vector<std::vector<OrientedFace>> oriented_faces(complex.blocks);
    for (std::size_t f = 0; f < complex.face_count(); ++f) {
        poll(progress, f);
        if (between_blocks &&
            complex.block(complex.cell(f, 0)) == complex.block(complex.cell(f, 1)))
            continue;
        for (const bool reversed : {false, true}) {
            const std::int32_t cell = complex.cell(f, reversed ? 1 : 0);
            if (cell < 0) continue;
            oriented_faces[index(complex.block(cell))].push_back(
                {static_cast<std::int32_t>(f), cell, reversed});
        }
    }
    return oriented_faces;
}

/// The numbers of the vertices that some polygons use, in rising order.
class Numbering {
public:
    explicit Numbering(std::size_t vertices)
        : words_((vertices + 63) / 64), before_(words_.size()) {}

    void use(std::int32_t vertex) { words_[static_cast<std::size_t>(vertex) / 64] |= bit(vertex); }
    /// Counts what is used; returns how many there are.
    std::size_t count() {
        std::int32_t sum = 0;
        for (std::size_t w = 0; w < words_.size(); ++w) {
            before_[w] = sum;
            sum += std::popcount(words_[w]);
        }
        return static_cast<std::size_t>(sum);
    }
    std::int32_t operator()(std::int32_t vertex) const {
        const auto w = static_cast<std::size_t>(vertex) / 64;
        return before_[w] + std::popcount(words_[w] & (bit(vertex) - 1));
    }

private:
    static std::uint64_t bit(std::int32_t vertex) {
        return std::uint64_t{1} << (static_cast<std::uint32_t>(vertex) % 64);
    }
    std::vector<std::uint64_t> words_;
    std::vector<std::int32_t> before_;
};

/// Adds a face's corners, as numbers of the complex, and its row.
void add_polygon(const ComplexView& complex, const OrientedFace& oriented_face, Shell& shell) {
    const auto corners = complex.face(index(oriented_face.face));
    if (oriented_face.reversed) {
        shell.corners.insert(shell.corners.end(), corners.rbegin(), corners.rend());
    } else {
        shell.corners.insert(shell.corners.end(), corners.begin(), corners.end());
    }
    shell.offsets.push_back(static_cast<std::int32_t>(shell.corners.size()));
    shell.faces.push_back(oriented_face.face);
    shell.reversed.push_back(oriented_face.reversed ? 1 : 0);
}

Shell begun(const ComplexView& complex, std::span<const OrientedFace> oriented_faces) {
    std::size_t corners = 0;
    for (const OrientedFace& oriented_face : oriented_faces)
        corners += complex.face(index(oriented_face.face)).size();
    if (std::cmp_greater(corners, std::numeric_limits<std::int32_t>::max()))
        throw InputError("too_large", "a block has more than 2^31 corners of faces", -1, {});
    Shell shell;
    shell.corners.reserve(corners);
    shell.offsets.reserve(oriented_faces.size() + 1);
    shell.faces.reserve(oriented_faces.size());
    shell.reversed.reserve(oriented_faces.size());
    shell.offsets.push_back(0);
    return shell;
}

std::array<float, 3> offset_from(const Position& origin, const Position& at) {
    return {static_cast<float>(at[0] - origin[0]), static_cast<float>(at[1] - origin[1]),
            static_cast<float>(at[2] - origin[2])};
}

Shell block_shell(const ComplexView& complex, std::span<const OrientedFace> oriented_faces,
                  const Position& origin) {
    Shell shell = begun(complex, oriented_faces);
    if (oriented_faces.empty()) return shell;
    Numbering number(complex.vertex_count());
    for (const OrientedFace& oriented_face : oriented_faces) {
        add_polygon(complex, oriented_face, shell);
        for (const std::int32_t v : complex.face(index(oriented_face.face)))
            number.use(v);
    }
    shell.coordinates.resize(number.count());
    for (std::int32_t& corner : shell.corners) {
        const std::int32_t vertex = corner;
        corner = number(vertex);
        shell.coordinates[index(corner)] = offset_from(origin, complex.vertex(vertex));
    }
    shell.edges = polygon_edges(shell.offsets, shell.corners, shell.coordinates.size());
    return shell;
}

/// Gives the corners of a cell, from `begin` on, vertices of their own.
void separate(const ComplexView& complex, std::size_t begin, double shrink, const Position& origin,
              std::vector<std::int32_t>& used, Shell& shell) {
    const std::span<std::int32_t> corners(
        shell.corners.begin() + static_cast<std::ptrdiff_t>(begin), shell.corners.end());
    used.assign(corners.begin(), corners.end());
    sort_unique(used);
    Position mean{};
    for (const std::int32_t v : used) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            mean[axis] += complex.vertex(v)[axis] - origin[axis];
    }
    const auto first = static_cast<std::int32_t>(shell.coordinates.size());
    for (const std::int32_t v : used) {
        std::array<float, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double center = mean[axis] / static_cast<double>(used.size());
            const double here = complex.vertex(v)[axis] - origin[axis];
            at[axis] = static_cast<float>(center + shrink * (here - center));
        }
        shell.coordinates.push_back(at);
    }
    for (std::int32_t& corner : corners)
        corner = first +
                 static_cast<std::int32_t>(std::ranges::lower_bound(used, corner) - used.begin());
}

Shell shell_of_cells(const ComplexView& complex, std::vector<OrientedFace>& oriented_faces,
                     double shrink, const Position& origin, Progress* progress) {
    std::ranges::stable_sort(oriented_faces, {}, &OrientedFace::cell);
    Shell shell = begun(complex, oriented_faces);
    shell.coordinates.reserve(shell.corners.capacity() / 3);
    std::vector<std::int32_t> used;
    for (const auto of_cell : groups_of(oriented_faces, &OrientedFace::cell)) {
        const std::size_t begin = shell.corners.size();
        for (const OrientedFace& oriented_face : of_cell) {
            poll(progress, shell.faces.size());
            add_polygon(complex, oriented_face, shell);
        }
        separate(complex, begin, shrink, origin, used, shell);
    }
    shell.edges = polygon_edges(shell.offsets, shell.corners, shell.coordinates.size());
    return shell;
}

}  // namespace

std::vector<Shell> block_shells(const ComplexView& complex, const Position& origin,
                                const Execution& execution) {
    require_in_range(complex, execution.progress);
    const auto oriented_faces = faces_by_block(complex, true, execution.progress);
    std::vector<Shell> shells(complex.blocks);
    parallel_chunks(complex.blocks, execution, [&](std::size_t block) {
        shells[block] = block_shell(complex, oriented_faces[block], origin);
    });
    return shells;
}

std::vector<Shell> cell_shells(const ComplexView& complex, double shrink, const Position& origin,
                               const Execution& execution) {
    require_in_range(complex, execution.progress);
    auto oriented_faces = faces_by_block(complex, false, execution.progress);
    std::vector<Shell> shells(complex.blocks);
    parallel_chunks(complex.blocks, execution, [&](std::size_t block) {
        shells[block] =
            shell_of_cells(complex, oriented_faces[block], shrink, origin, execution.progress);
        oriented_faces[block] = {};
    });
    return shells;
}

}  // namespace realmodel::shells
