// SPDX-License-Identifier: GPL-3.0-or-later
#include "complex_defects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "base/floating_point.hpp"

namespace realmodel::fuzz {

namespace {

using strata::CellComplex;

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Collects defects of which there may be thousands: one of each kind, with their number.
class Findings {
public:
    void add(const std::string& kind, const std::string& sentence) {
        auto [place, is_new] = found_.try_emplace(kind, 0, sentence);
        ++place->second.first;
    }
    std::vector<Defect> defects() const {
        std::vector<Defect> result;
        for (const auto& [kind, what] : found_)
            result.push_back({kind, std::to_string(what.first) + "; first: " + what.second});
        return result;
    }

private:
    std::map<std::string, std::pair<int, std::string>> found_;
};

class View {
public:
    explicit View(const CellComplex& complex) : c(complex) {}

    std::size_t faces() const { return c.face_cells.size(); }
    std::span<const std::int32_t> corners(std::size_t face) const {
        const auto begin = static_cast<std::size_t>(c.face_offsets[face]);
        return std::span(c.face_vertices)
            .subspan(begin, static_cast<std::size_t>(c.face_offsets[face + 1]) - begin);
    }
    const Point& at(std::int32_t vertex) const {
        return c.vertices[static_cast<std::size_t>(vertex)];
    }
    std::int32_t block(std::int32_t cell) const {
        return cell < 0 ? -1 : c.cell_block[static_cast<std::size_t>(cell)];
    }
    /// Twice the area vector.
    Point normal(std::size_t face) const {
        const auto v = corners(face);
        Point sum{};
        for (std::size_t i = 1; i + 1 < v.size(); ++i) {
            const Point part = cross(minus(at(v[i]), at(v[0])), minus(at(v[i + 1]), at(v[0])));
            for (std::size_t axis = 0; axis < 3; ++axis)
                sum[axis] += part[axis];
        }
        return sum;
    }
    /// Spacing of doubles at the largest coordinate in plan.
    double plan_step() const {
        double largest = 0;
        for (const Point& p : c.vertices)
            largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
        return ulp(largest);
    }

    const CellComplex& c;
};

bool shapes_are_right(const CellComplex& c, Findings& findings) {
    const auto wrong = [&](const std::string& what) {
        findings.add("shape", what);
        return false;
    };
    if (c.face_offsets.size() != c.face_cells.size() + 1 || c.face_offsets.front() != 0 ||
        c.face_offsets.back() != static_cast<std::int64_t>(c.face_vertices.size()) ||
        c.face_surface.size() != c.face_cells.size())
        return wrong("lengths of the face arrays");
    const auto vertices = static_cast<std::int32_t>(c.vertices.size());
    const auto cells = static_cast<std::int32_t>(c.cell_block.size());
    for (const std::int32_t v : c.face_vertices) {
        if (v < 0 || v >= vertices) return wrong("face_vertices out of range");
    }
    std::vector<bool> has_faces(c.cell_block.size(), false);
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        if (c.face_offsets[f + 1] - c.face_offsets[f] < 3) return wrong("a face of two corners");
        const auto [a, b] = c.face_cells[f];
        if (a < 0 || a >= cells || b < -1 || b >= cells) return wrong("face_cells out of range");
        if (a == b) return wrong("a face with one cell on both sides");
        has_faces[static_cast<std::size_t>(a)] = true;
        if (b >= 0) has_faces[static_cast<std::size_t>(b)] = true;
        if (c.face_surface[f] < -2 || c.face_surface[f] >= static_cast<int>(c.volumes.size()))
            return wrong("face_surface out of range");
    }
    for (const std::int32_t block : c.cell_block) {
        if (block < 0 || block >= static_cast<int>(c.volumes.size()))
            return wrong("cell_block out of range");
    }
    if (!std::all_of(has_faces.begin(), has_faces.end(), [](bool has) { return has; }))
        return wrong("a cell without faces");
    for (const Point& p : c.vertices) {
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
            return wrong("a vertex that is not finite");
    }
    return true;
}

void check_vertices(const View& view, Findings& findings) {
    std::set<Point> positions;
    for (const Point& p : view.c.vertices) {
        if (!positions.insert({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}).second)
            findings.add("equal vertices",
                         "at " + std::to_string(p[0]) + " " + std::to_string(p[1]));
    }
    std::vector<bool> used(view.c.vertices.size(), false);
    for (std::size_t f = 0; f < view.faces(); ++f) {
        const auto v = view.corners(f);
        for (const std::int32_t i : v)
            used[static_cast<std::size_t>(i)] = true;
        if (std::set<std::int32_t>(v.begin(), v.end()).size() != v.size())
            findings.add("repeated vertex", "face " + std::to_string(f));
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) findings.add("unused vertices", "vertex " + std::to_string(v));
    }
}

void check_closed(const View& view, Cells cells, Findings& findings) {
    std::vector<std::tuple<std::int32_t, std::int32_t, std::int32_t, bool>> uses;
    for (std::size_t f = 0; f < view.faces(); ++f) {
        const auto v = view.corners(f);
        for (std::size_t i = 0; i < v.size(); ++i) {
            const std::int32_t a = v[i], b = v[(i + 1) % v.size()];
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t cell = view.c.face_cells[f][side];
                if (cell >= 0)
                    uses.emplace_back(cell, std::min(a, b), std::max(a, b), (a < b) == (side == 0));
            }
        }
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size();) {
        const auto [cell, a, b, ahead] = uses[i];
        int forward = 0, backward = 0;
        for (; i < uses.size() &&
               std::tie(cell, a, b) ==
                   std::tie(std::get<0>(uses[i]), std::get<1>(uses[i]), std::get<2>(uses[i]));
             ++i)
            ++(std::get<3>(uses[i]) ? forward : backward);
        if (forward != backward || (cells == Cells::kColumns && forward != 1)) {
            findings.add("not closed", "cell " + std::to_string(cell) + ", edge " +
                                           std::to_string(a) + "-" + std::to_string(b) + " used " +
                                           std::to_string(forward) + " and " +
                                           std::to_string(backward) + " times");
        }
    }
}

void check_volumes(const View& view, Findings& findings) {
    const CellComplex& c = view.c;
    const std::vector<double> volume = cell_volumes(c);
    std::vector<Point> low(volume.size(), {HUGE_VAL, HUGE_VAL, HUGE_VAL}),
        high(volume.size(), {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL});
    for (std::size_t f = 0; f < view.faces(); ++f) {
        for (const std::int32_t cell : c.face_cells[f]) {
            if (cell < 0) continue;
            for (const std::int32_t v : view.corners(f)) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    double& least = low[static_cast<std::size_t>(cell)][axis];
                    double& most = high[static_cast<std::size_t>(cell)][axis];
                    least = std::min(least, view.at(v)[axis]);
                    most = std::max(most, view.at(v)[axis]);
                }
            }
        }
    }
    std::vector<double> sums(c.volumes.size(), 0), allowed(c.volumes.size(), 0);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        double largest = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest = std::max({largest, std::abs(low[i][axis]), std::abs(high[i][axis])});
        const Point size = minus(high[i], low[i]);
        const double step = ulp(largest);
        const double rounding =
            16 * step * (size[0] * size[1] + size[1] * size[2] + size[0] * size[2] + step * step);
        if (volume[i] < -rounding)
            findings.add("negative volume",
                         "cell " + std::to_string(i) + " " + std::to_string(volume[i]));
        if (*std::min_element(size.begin(), size.end()) == 0)
            findings.add("flat cells", "cell " + std::to_string(i));
        const auto block = static_cast<std::size_t>(c.cell_block[i]);
        sums[block] += volume[i];
        allowed[block] += rounding + 1e-9 * std::abs(volume[i]);
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (std::abs(sums[k] - c.volumes[k]) > allowed[k]) {
            findings.add("stated volume", "block " + std::to_string(k) + " has " +
                                              std::to_string(c.volumes[k]) + ", its cells " +
                                              std::to_string(sums[k]));
        }
    }
}

/// Walls are vertical, other faces convex in plan and turned one way; up to rounding.
void check_faces(const View& view, Findings& findings) {
    const double step = view.plan_step();
    double largest = 0;
    for (const Point& p : view.c.vertices)
        largest = std::max({largest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    const double small = 1e6 * ulp(largest);
    for (std::size_t f = 0; f < view.faces(); ++f) {
        const auto v = view.corners(f);
        const Point normal = view.normal(f);
        const double area = std::sqrt(dot(normal, normal)) / 2;
        if (view.c.face_surface[f] == strata::kWall) {
            if (area > small * small && std::abs(normal[2]) / 2 > 1e-6 * area)
                findings.add("leaning wall", "face " + std::to_string(f));
            continue;
        }
        const double way = normal[2] < 0 ? -1 : 1;
        for (std::size_t i = 0; i < v.size(); ++i) {
            const Point &p = view.at(v[i]), &q = view.at(v[(i + 1) % v.size()]),
                        &r = view.at(v[(i + 2) % v.size()]);
            const double ax = q[0] - p[0], ay = q[1] - p[1], bx = r[0] - q[0], by = r[1] - q[1];
            const double reach = std::abs(ax) + std::abs(ay) + std::abs(bx) + std::abs(by);
            if (way * (ax * by - ay * bx) < -64 * step * reach) {
                findings.add("not convex", "face " + std::to_string(f) + " at vertex " +
                                               std::to_string(v[(i + 1) % v.size()]));
                break;
            }
        }
    }
}

}  // namespace

bool were_borders_joined(const CellComplex& complex) {
    return std::any_of(complex.warnings.begin(), complex.warnings.end(),
                       [](const strata::Warning& warning) { return warning.kind == "joined"; });
}

std::vector<double> cell_volumes(const CellComplex& c) {
    const View view(c);
    std::vector<std::int32_t> anchor(c.cell_block.size(), -1);
    for (std::size_t f = 0; f < view.faces(); ++f) {
        for (const std::int32_t cell : c.face_cells[f]) {
            if (cell >= 0) anchor[static_cast<std::size_t>(cell)] = view.corners(f)[0];
        }
    }
    std::vector<double> volume(c.cell_block.size(), 0);
    for (std::size_t f = 0; f < view.faces(); ++f) {
        const auto v = view.corners(f);
        double sign = 1.0 / 6;
        for (const std::int32_t cell : c.face_cells[f]) {
            if (cell >= 0) {
                const Point origin = view.at(anchor[static_cast<std::size_t>(cell)]);
                for (std::size_t i = 1; i + 1 < v.size(); ++i) {
                    volume[static_cast<std::size_t>(cell)] +=
                        sign *
                        dot(minus(view.at(v[0]), origin),
                            cross(minus(view.at(v[i]), origin), minus(view.at(v[i + 1]), origin)));
                }
            }
            sign = -sign;
        }
    }
    return volume;
}

std::vector<Defect> complex_defects(const CellComplex& complex, Cells cells) {
    Findings findings;
    if (shapes_are_right(complex, findings)) {
        const View view(complex);
        check_vertices(view, findings);
        check_closed(view, cells, findings);
        check_volumes(view, findings);
        check_faces(view, findings);
    }
    return findings.defects();
}

std::vector<Defect> boundary_differences(const CellComplex& columns, const CellComplex& blocks) {
    using Key = std::tuple<std::int32_t, std::int32_t, std::int32_t>;  // blocks, surface
    const auto areas = [](const CellComplex& c, double& step) {
        const View view(c);
        std::map<Key, double> area;
        for (std::size_t f = 0; f < view.faces(); ++f) {
            std::int32_t a = view.block(c.face_cells[f][0]), b = view.block(c.face_cells[f][1]);
            if (a == b) continue;
            if (a > b) std::swap(a, b);
            const Point normal = view.normal(f);
            area[{a, b, c.face_surface[f]}] += std::sqrt(dot(normal, normal)) / 2;
        }
        for (const Point& p : c.vertices) {
            for (const double x : p)
                step = std::max(step, ulp(x));
        }
        return area;
    };
    double step = 0;
    std::map<Key, double> one = areas(columns, step), other = areas(blocks, step);
    Point low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const Point& p : columns.vertices) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    const Point size = minus(high, low);
    const double extent = std::max({size[0], size[1], size[2], 0.0});
    Findings findings;
    for (const auto& [key, area] : other)
        one.try_emplace(key, 0.0);
    for (const auto& [key, area] : one) {
        const double merged = other.count(key) > 0 ? other[key] : 0.0;
        const double allowed =
            1e-6 * area + 64 * step * extent * static_cast<double>(columns.face_cells.size());
        if (std::abs(area - merged) > allowed) {
            const auto [a, b, surface] = key;
            findings.add("boundaries differ",
                         "between blocks " + std::to_string(a) + " and " + std::to_string(b) +
                             " on surface " + std::to_string(surface) + " columns have " +
                             std::to_string(area) + ", blocks " + std::to_string(merged));
        }
    }
    return findings.defects();
}

}  // namespace realmodel::fuzz
