// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "simulation/cleaning/editable_complex.hpp"

namespace realmodel::simulation {

namespace {

/// Cells of more faces (whole blocks) are tested around the change only.
constexpr std::size_t kFewFaces = 48;
constexpr std::size_t kLeastFaces = 3;
/// Of the area to the power of 3/2. Cells of less volume count as flat.
constexpr double kLeastVolume = 1e-8;

bool is_flat(const CellShape& cell) {
    return cell.volume <= kLeastVolume * cell.area * std::sqrt(cell.area);
}

/// Whether two loops have the same corners in the same or in the opposite order.
bool same_ring(std::span<const std::int32_t> a, std::span<const std::int32_t> b, bool reversed) {
    const std::size_t n = a.size();
    if (b.size() != n) return false;
    const auto begin = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[0]) - b.begin());
    if (begin == n) return false;
    for (std::size_t i = 0; i < n; ++i) {
        if (a[i] != b[(begin + (reversed ? n - i : i)) % n]) return false;
    }
    return true;
}

}  // namespace

/// Calls visit(face) for what the change leaves of the faces at a vertex, and for those it adds.
template <class Visit>
void ChangeCheck::for_faces_after(const Change& change, std::int32_t vertex,
                                  const Visit& visit) const {
    for (const std::int32_t f : complex_.vertex_faces(vertex)) {
        if (!is_removed(f)) visit(f);
    }
    for (std::size_t i = 0; i < change.added.size(); ++i)
        visit(-1 - static_cast<std::int32_t>(i));
}

bool ChangeCheck::settle(Change& change, std::int32_t vertex) {
    if (vertex >= 0 && !join_equal_faces(change, vertex)) return false;
    removed_ = change.removed;
    std::sort(removed_.begin(), removed_.end());
    return keeps_faces(change) && keeps_cells(change) &&
           (vertex < 0 || keeps_edges(change, vertex));
}

bool ChangeCheck::join_equal_faces(Change& change, std::int32_t vertex) {
    removed_ = change.removed;
    std::sort(removed_.begin(), removed_.end());
    entries_.clear();
    const auto add = [&](std::int32_t face) {
        const FaceLoop loop = loop_of(change, face);
        if (!contains(loop, vertex)) return;
        KeyedFace entry{{loop.size(), 0}, face};
        for (const std::int32_t v : loop) {
            const auto word = (static_cast<std::uint64_t>(v) + 1) * 0x9E3779B97F4A7C15u;
            entry.key[0] += word ^ (word >> 31);
            entry.key[1] ^= word;
        }
        entries_.push_back(entry);
    };
    for_faces_after(change, vertex, add);
    std::ranges::stable_sort(entries_, {}, &KeyedFace::key);
    std::vector<std::int32_t> equal;
    for (const auto group : groups_of(entries_, &KeyedFace::key)) {
        if (group.size() == 1) continue;
        equal = transformed(group, &KeyedFace::face);
        while (equal.size() > 1) {
            if (!join_pair(change, equal)) return false;
        }
    }
    // faces that were joined with another have no cells any more
    std::erase_if(change.added, [](const Change::AddedFace& face) { return face.cells[0] < 0; });
    return true;
}

/// Joins two of some equal faces that are of one cell.
bool ChangeCheck::join_pair(Change& change, std::vector<std::int32_t>& equal) const {
    for (std::size_t i = 0; i < equal.size(); ++i) {
        for (std::size_t j = i + 1; j < equal.size(); ++j) {
            const auto first = cells_of(change, equal[i]), second = cells_of(change, equal[j]);
            for (std::size_t s = 0; s < 2; ++s) {
                const std::size_t t = second[0] == first[s] ? 0 : 1;
                if (second[t] != first[s]) continue;
                // one cell has both, so seen from there they turn in opposite directions
                if (!same_ring(loop_of(change, equal[i]), loop_of(change, equal[j]), s == t))
                    continue;
                change.tested.push_back(first[s]);
                const std::int32_t x = first[1 - s], y = second[1 - t];
                if (x == y && x >= 0) return false;
                const std::int32_t of_x = surface_of(change, equal[i]),
                                   of_y = surface_of(change, equal[j]);
                // the loop as the first cell has it is the one that y sees from outside
                FaceLoop loop = loop_of(change, equal[i]);
                std::vector<std::int32_t> ring(loop.begin(), loop.end());
                if ((s == 1) != (y < 0)) std::reverse(ring.begin(), ring.end());
                std::int32_t surface = std::max(of_x, of_y);
                if (x < 0) surface = of_x;
                if (y < 0) surface = of_y;
                if (is_fault(of_x)) surface = of_x;
                if (is_fault(of_y)) surface = of_y;
                for (const std::int32_t face : {equal[i], equal[j]}) {
                    if (face >= 0)
                        change.removed.push_back(face);
                    else
                        change.added[index(-1 - face)].cells = {-1, -1};
                }
                const std::int32_t origin =
                    equal[i] >= 0 ? equal[i] : change.added[index(-1 - equal[i])].origin;
                equal.erase(equal.begin() + static_cast<std::ptrdiff_t>(j));
                equal.erase(equal.begin() + static_cast<std::ptrdiff_t>(i));
                if (x < 0 && y < 0) return true;
                change.added.push_back({origin,
                                        static_cast<std::uint32_t>(change.corners.size()),
                                        static_cast<std::uint32_t>(ring.size()),
                                        {y >= 0 ? y : x, y >= 0 ? x : y},
                                        surface,
                                        true,
                                        {}});
                change.corners.insert(change.corners.end(), ring.begin(), ring.end());
                equal.push_back(-static_cast<std::int32_t>(change.added.size()));
                return true;
            }
        }
    }
    return false;
}

/// Sets the shapes of the added faces; false where one turns over.
bool ChangeCheck::keeps_faces(Change& change) const {
    for (Change::AddedFace& face : change.added) {
        face.shape = complex_.shape_of(change.loop(face));
        if (!face.is_joined && !(dot(face.shape.area, complex_.shape(face.origin).area) > 0))
            return false;
    }
    return true;
}

bool ChangeCheck::keeps_cells(const Change& change) {
    beside_.clear();
    for (const std::int32_t f : removed_) {
        for (const std::int32_t c : complex_.cells(f))
            beside_.push_back({c, f});
    }
    for (std::size_t i = 0; i < change.added.size(); ++i) {
        for (const std::int32_t c : change.added[i].cells)
            beside_.push_back({c, -1 - static_cast<std::int32_t>(i)});
    }
    std::sort(beside_.begin(), beside_.end());
    block_change_.clear();
    for (const auto of_cell : groups_of(beside_, &Beside::cell)) {
        if (!keeps_cell(change, of_cell[0].cell, of_cell)) return false;
    }
    std::sort(block_change_.begin(), block_change_.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    double total = 0;
    volume_change_ = 0;
    for (const auto of_block : groups_of(block_change_, &BlockChange::first)) {
        double sum = 0;
        for (const auto& [block, change_of_cell] : of_block) {
            sum += change_of_cell;
            total += change_of_cell;
        }
        volume_change_ += std::abs(sum);
    }
    volume_change_ += 2 * std::abs(total);
    return true;
}

/// @param sides  the removed and the added faces of the cell, added ones first
bool ChangeCheck::keeps_cell(const Change& change, std::int32_t cell,
                             std::span<const Beside> sides) {
    const bool is_small = cell >= 0 && complex_.cell_faces(cell).size() <= kFewFaces;
    const bool is_tested = contains(change.tested, cell);
    if (is_small) {
        const auto faces = complex_.cell_faces(cell);
        before_.assign(faces.begin(), faces.end());
    } else {
        before_.clear();
        if (is_tested) take_surroundings(change, cell, sides);
    }
    after_.clear();
    for (const std::int32_t f : before_) {
        if (!is_removed(f)) after_.push_back(f);
    }
    for (const Beside& side : sides) {
        if (side.face < 0) after_.push_back(side.face);
    }
    double volume = 0;
    if (!is_small || !after_.empty()) {
        if (is_small && after_.size() < kLeastFaces) return false;
        if (cell >= 0 && !(is_small ? keeps_shape(change, cell, volume)
                                    : keeps_volume(change, cell, sides, volume)))
            return false;
        int doubled_before = 0, doubled = 0;
        if (is_tested && (euler_number(change, cell, before_, doubled_before) !=
                              euler_number(change, cell, after_, doubled) ||
                          doubled > doubled_before))
            return false;
    }
    if (cell >= 0)
        block_change_.emplace_back(complex_.block(cell), volume - complex_.cell(cell).volume);
    return true;
}

/// All faces of the cell at the vertices of removed and added ones: beyond these nothing changes.
void ChangeCheck::take_surroundings(const Change& change, std::int32_t cell,
                                    std::span<const Beside> sides) {
    vertices_.clear();
    for (const Beside& side : sides) {
        const FaceLoop loop = loop_of(change, side.face);
        vertices_.insert(vertices_.end(), loop.begin(), loop.end());
    }
    sort_unique(vertices_);
    for (const std::int32_t v : vertices_) {
        for (const std::int32_t f : complex_.vertex_faces(v)) {
            const auto [a, b] = complex_.cells(f);
            if (a == cell || b == cell) before_.push_back(f);
        }
    }
    sort_unique(before_);
}

/// Of a cell whose faces after_ has.
bool ChangeCheck::keeps_shape(const Change& change, std::int32_t cell, double& volume) {
    seen_.clear();
    for (const std::int32_t f : after_)
        seen_.push_back({shape_of(change, f), cells_of(change, f)[0] == cell ? 1.0 : -1.0});
    const CellShape& old = complex_.cell(cell);
    const CellShape shape = cell_shape(seen_);
    volume = shape.volume;
    // a cell that rounding made flat or turned over before may stay so until it vanishes
    return (!is_flat(shape) || (is_flat(old) && volume >= old.volume)) &&
           shape.turned_faces <= old.turned_faces;
}

/// Of a cell of many faces.
bool ChangeCheck::keeps_volume(const Change& change, std::int32_t cell,
                               std::span<const Beside> sides, double& volume) const {
    const CellShape& old = complex_.cell(cell);
    const Vec3 from = complex_.point(loop_of(change, sides[0].face)[0]);
    volume = old.volume;
    for (const Beside& side : sides) {
        const FaceVectors& shape = shape_of(change, side.face);
        const bool adds = (side.face < 0) == (cells_of(change, side.face)[0] == cell);
        volume += (adds ? 1 : -1) * dot(shape.area, minus(shape.center, from)) / 3;
    }
    return volume > kLeastVolume * old.area * std::sqrt(old.area);
}

/// Vertices less edges and faces of some faces of a cell; `doubled`: how often an edge is used
/// again in the same direction.
int ChangeCheck::euler_number(const Change& change, std::int32_t cell,
                              std::span<const std::int32_t> faces, int& doubled) {
    edges_.clear();
    vertices_.clear();
    for (const std::int32_t f : faces) {
        const FaceLoop loop = loop_of(change, f);
        const bool is_reversed = cells_of(change, f)[0] != cell;
        std::int32_t from = loop.back();
        for (const std::int32_t to : loop) {
            edges_.emplace_back(is_reversed ? to : from, is_reversed ? from : to);
            from = to;
        }
        vertices_.insert(vertices_.end(), loop.begin(), loop.end());
    }
    const std::size_t uses = edges_.size();
    sort_unique(vertices_);
    sort_unique(edges_);
    doubled = static_cast<int>(uses - edges_.size());
    for (auto& [from, to] : edges_) {
        if (from > to) std::swap(from, to);
    }
    sort_unique(edges_);
    return static_cast<int>(vertices_.size() + faces.size()) - static_cast<int>(edges_.size());
}

/// Whether around each edge at a vertex cells and faces follow one another in one round.
bool ChangeCheck::keeps_edges(const Change& change, std::int32_t vertex) {
    around_.clear();
    const auto add = [&](std::int32_t face) {
        const auto neighbors = beside(loop_of(change, face), vertex);
        if (!neighbors) return;
        for (const std::int32_t v : *neighbors)
            around_.push_back({v, cells_of(change, face)});
    };
    for_faces_after(change, vertex, add);
    std::ranges::stable_sort(around_, {}, &Around::vertex);
    for (const auto around_edge : groups_of(around_, &Around::vertex)) {
        if (!is_round(around_edge)) return false;
    }
    return true;
}

/// Whether faces follow one another in one round, each cell between two of them.
bool ChangeCheck::is_round(std::span<Around> faces) {
    std::int32_t cell = faces[0].cells[1];
    for (std::size_t next = 1; next < faces.size(); ++next) {
        const auto has_cell = [&](const Around& face) {
            return face.cells[0] == cell || face.cells[1] == cell;
        };
        const auto rest = faces.subspan(next);
        const auto face = std::find_if(rest.begin(), rest.end(), has_cell);
        if (face == rest.end() || std::find_if(face + 1, rest.end(), has_cell) != rest.end())
            return false;
        cell = face->cells[0] == cell ? face->cells[1] : face->cells[0];
        std::swap(rest.front(), *face);
    }
    return cell == faces[0].cells[0];
}

}  // namespace realmodel::simulation
