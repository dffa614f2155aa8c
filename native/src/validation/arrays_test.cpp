// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/arrays_test.hpp"

#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/strata/stack.hpp"
#include "validation/chunked.hpp"

namespace realmodel::validation {

namespace {

std::string number(std::int64_t value) {
    return std::to_string(value);
}

Findings check_lengths(const ComplexView& m) {
    Findings found;
    const auto fail = [&](std::string text) { found.fail([&] { return Offender{.text = text}; }); };
    constexpr auto kLargest = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    const std::size_t faces = m.face_count();
    if (m.vertices.size() % 3 != 0) fail("the coordinates are not in threes");
    if (m.face_cells.size() != 2 * faces || m.face_surface.size() != faces)
        fail("face_cells has not two cells for each face, or face_surface not one surface");
    if (m.face_offsets.size() != faces + 1) {
        fail("face_offsets has " + std::to_string(m.face_offsets.size()) + " entries for " +
             std::to_string(faces) + " faces");
    } else if (m.face_offsets.front() != 0 ||
               m.face_offsets.back() != static_cast<std::int64_t>(m.face_vertices.size())) {
        fail("face_offsets does not run from 0 to the number of corners");
    }
    if (m.block_volume.size() != m.blocks ||
        (!m.block_base.empty() && m.block_base.size() != m.blocks))
        fail("blocks without a volume or base");
    if (2 * faces > kLargest || m.vertex_count() > kLargest || m.cell_count() > kLargest)
        fail("there are more faces, vertices or cells than 32-bit numbers can name");
    return found;
}

void check_face(const ComplexView& m, std::size_t f, std::vector<std::uint8_t>& has_face,
                Findings& found) {
    const auto face = static_cast<std::int64_t>(f);
    const auto fail = [&](const auto& text) {
        found.fail([&] { return Offender{.text = text(), .face = face}; });
    };
    const std::int64_t begin = m.face_offsets[f], end = m.face_offsets[f + 1];
    const auto corners = static_cast<std::int64_t>(m.face_vertices.size());
    if (begin < 0 || end > corners || end - begin < 3) {
        fail([&] { return "face " + number(face) + " has " + number(end - begin) + " corners"; });
        return;
    }
    for (const std::int32_t v : m.face(f)) {
        if (v >= 0 && static_cast<std::size_t>(v) < m.vertex_count()) continue;
        fail([&] { return "face " + number(face) + " names vertex " + number(v); });
        return;
    }
    const std::int32_t first = m.cell(f, 0), second = m.cell(f, 1);
    const auto cells = static_cast<std::int64_t>(m.cell_count());
    if (first < 0 || first >= cells || second < -1 || second >= cells || first == second) {
        fail([&] {
            return "face " + number(face) + " lies between cells " + number(first) + " and " +
                   number(second);
        });
        return;
    }
    for (const std::int32_t cell : {first, second}) {
        if (cell >= 0) mark(has_face[index(cell)]);
    }
    if (m.face_surface[f] < kCutFace || m.face_surface[f] >= m.surfaces) {
        fail(
            [&] { return "face " + number(face) + " names surface " + number(m.face_surface[f]); });
    }
}

void check_cell(const ComplexView& m, std::size_t c, const std::vector<std::uint8_t>& has_face,
                Findings& found) {
    const auto cell = static_cast<std::int64_t>(c);
    const std::int32_t block = m.cell_block[c];
    if (block < 0 || static_cast<std::size_t>(block) >= m.blocks) {
        found.fail([&] {
            return Offender{.text = "cell " + number(cell) + " names block " + number(block),
                            .cell = cell};
        });
    } else if (has_face[c] == 0) {
        found.fail([&] {
            return Offender{.text = "cell " + number(cell) + " has no faces", .cell = cell};
        });
    }
}

void check_vertex(const ComplexView& m, std::size_t v, Findings& found) {
    const auto position = m.vertex(static_cast<std::int32_t>(v));
    if (std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]))
        return;
    const auto vertex = static_cast<std::int64_t>(v);
    found.fail([&] {
        return Offender{.text = "vertex " + number(vertex) + " is not finite", .vertex = vertex};
    });
}

}  // namespace

Findings check_arrays(const ComplexView& m, const Execution& execution) {
    Findings found = check_lengths(m);
    if (!found.passed()) return found;
    std::vector<std::uint8_t> has_face(m.cell_count(), 0);
    const auto face = [&](std::size_t f, Findings& own) { check_face(m, f, has_face, own); };
    const auto cell = [&](std::size_t c, Findings& own) { check_cell(m, c, has_face, own); };
    const auto vertex = [&](std::size_t v, Findings& own) { check_vertex(m, v, own); };
    found = look_at_each(m.face_count(), execution, face);
    found.append(look_at_each(m.cell_count(), execution, cell));
    found.append(look_at_each(m.vertex_count(), execution, vertex));
    found.examined = static_cast<std::int64_t>(m.face_count());
    return found;
}

}  // namespace realmodel::validation
