// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/element_quality.hpp"

#include <algorithm>
#include <cmath>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"

namespace realmodel::simulation {

namespace {

/// How far from its center a face is crossed, as checkMesh measures it: 1 is the edge of the face.
/// 0 where the line alone shows that it is less than kMostSkewness.
/// @param way  from the center of an element to that of the face
/// @param line  from there to the other element; at the outside to the plane of the face, upright
/// @param share  of the length of the line that counts as the size of a smaller face
double skewness(const ElementFace& face, const Vec3& way, const Vec3& line, double share) {
    const double ratio = dot(way, face.area) / dot(line, face.area);
    const Vec3 off = minus(way, times(ratio, line));  // from where the line crosses the face
    constexpr double kClear = 0.99 * kMostSkewness;
    if (dot(off, off) <= kClear * kClear * share * share * dot(line, line)) return 0;
    const double far = length(off);
    double reach = share * length(line);
    for (const Vec3& corner : face.corners)
        reach = std::max(reach, std::abs(dot(off, minus(corner, face.center))) / far);
    return far / reach;
}

}  // namespace

double inner_skewness(const ElementFace& face, const Vec3& center, const Vec3& other) {
    return skewness(face, minus(face.center, center), minus(other, center), 0.2);
}

double outer_skewness(const ElementFace& face, const Vec3& center) {
    const Vec3 way = minus(face.center, center);
    const double share = dot(way, face.area) / dot(face.area, face.area);
    return skewness(face, way, times(share, face.area), 0.4);
}

bool is_bad(const ElementFace& face, const ElementBody& body, const ElementBody& other) {
    const Vec3 line = minus(other.center, body.center), way = minus(face.center, body.center);
    const double along = dot(line, face.area), size = length(face.area);
    if (along < kMostLean * size * length(line)) return true;
    const double before = std::abs(dot(way, face.area)),
                 behind = std::abs(dot(minus(other.center, face.center), face.area));
    if (std::min(before, behind) < kLeastWeight * (before + behind)) return true;
    if (std::min(body.volume, other.volume) < kLeastShare * std::max(body.volume, other.volume))
        return true;
    return inner_skewness(face, body.center, other.center) > kMostSkewness;
}

ElementFace lateral_face(const Vec2& a, const Vec2& b, const std::array<double, 2>& low,
                         const std::array<double, 2>& high) {
    const double at_a = high[0] - low[0], at_b = high[1] - low[1], sum = at_a + at_b;
    ElementFace face{{{{a[0], a[1], low[0]},
                       {b[0], b[1], low[1]},
                       {b[0], b[1], high[1]},
                       {a[0], a[1], high[0]}}},
                     {(b[1] - a[1]) * sum / 2, -(b[0] - a[0]) * sum / 2, 0},
                     {}};
    // of the two triangles at the diagonal from the first corner, the first is as large as at_b
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& c = face.corners;
        face.center[k] =
            (at_b * (c[0][k] + c[1][k] + c[2][k]) + at_a * (c[0][k] + c[2][k] + c[3][k])) /
            (3 * sum);
    }
    return face;
}

double determinant_of(std::span<const Vec3> areas) {
    double mean = 0;
    for (const Vec3& area : areas)
        mean += length(area);
    if (!(mean > 0)) return 0;
    mean /= static_cast<double>(areas.size());
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (const Vec3& area : areas) {
        const double x = area[0] / mean, y = area[1] / mean, z = area[2] / mean;
        xx += x * x;
        xy += x * y;
        xz += x * z;
        yy += y * y;
        yz += y * z;
        zz += z * z;
    }
    return std::abs(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) +
                    xz * (xy * yz - yy * xz)) /
           8;
}

namespace {

constexpr double kSteepFace = 0.5;       ///< cosine: of 60 degrees
constexpr double kNoDeterminant = 1e-8;  ///< inner faces in two directions only
constexpr double kThickEnd = 3;          ///< minimum thicknesses: no block gives up an end as thick
constexpr double kRelaxedFace = 0.8;     ///< cosine: flatter faces are not what makes lines lean
constexpr double kRelaxedShare = 0.1;

}  // namespace

ElementQuality::ElementQuality(const PlanTopology& plan, const PillarLevels& levels,
                               const ColumnFronts& columns, double minimum_thickness,
                               Progress* progress)
    : plan_(plan),
      levels_(levels),
      columns_(columns),
      minimum_thickness_(minimum_thickness),
      progress_(progress),
      open_edges_(columns.fronts.size(), 0) {
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        poll(progress, t);
        for (std::size_t i = 0; i < 3; ++i) {
            if (shares_lateral_faces(t, i)) continue;
            for_lateral_faces(t, i, [&](std::size_t element, bool is_shared, std::size_t) {
                if (!is_shared)
                    open_edges_[element] =
                        static_cast<std::uint8_t>(open_edges_[element] | 1U << i);
            });
        }
    }
}

/// Whether the columns beside an edge have all their sides there in common.
bool ElementQuality::shares_lateral_faces(std::size_t t, std::size_t edge) const {
    const std::int32_t n = plan_.neighbor(t, edge);
    return n >= 0 && !plan_.is_inner_step(t, edge) && columns_.elements(index(n)) > 0;
}

/// Both columns beside an edge have the heights of its ends in ascending order, so one pass over
/// both finds the sides that they share.
template <class Visit>
void ElementQuality::for_lateral_faces(std::size_t t, std::size_t edge, const Visit& visit) const {
    using LateralFace = std::array<std::int32_t, 4>;
    const std::size_t i = edge, j = (edge + 1) % 3;
    const meshing::HalfEdge twin = plan_.twin(t, i);
    std::size_t at = 0, end = 0, u = 0, v = 0;
    if (!twin.is_none()) {
        at = columns_.offset[index(twin.triangle())];
        end = at + columns_.elements(index(twin.triangle()));
        u = index(twin.next().index());
        v = index(twin.index());
    }
    const auto heights_between = [&](std::size_t e, std::size_t from, std::size_t to) {
        const LevelFront &low = columns_.fronts[e], &high = columns_.fronts[e + 1];
        return LateralFace{low[from], low[to], high[from], high[to]};
    };
    const auto is_empty = [](const LateralFace& s) { return s[0] == s[2] && s[1] == s[3]; };
    const std::size_t first = columns_.offset[t];
    for (std::size_t e = first; e < first + columns_.elements(t); ++e) {
        const LateralFace heights = heights_between(e, i, j);
        if (is_empty(heights)) continue;
        while (at < end &&
               (is_empty(heights_between(at, u, v)) || heights_between(at, u, v) < heights))
            ++at;
        visit(e, at < end && heights_between(at, u, v) == heights, at);
    }
}

ElementQuality::Removals ElementQuality::weak(std::span<const std::uint8_t> is_narrow) const {
    Removals removals;
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        // sides of walls that nothing stands behind are left to failing(), which gives up less
        unsigned border = 0;
        for (std::size_t i = 0; i < 3; ++i)
            border |= plan_.neighbor(t, i) < 0 ? 1U << i : 0U;
        const std::size_t first = columns_.offset[t], count = columns_.elements(t);
        const ColumnCorners at = corners(t);
        for (std::size_t e = first; e < first + count; ++e) {
            const bool is_first = e == first, is_last = e + 1 == first + count;
            const LevelFront &low = columns_.fronts[e], &high = columns_.fronts[e + 1];
            if (moved_corners(e) == 3) {
                // a prism may become one with the next layer of its block, no more
                if (border == 0 && !is_first && !is_last) continue;
                if (is_first == is_last || count < 3 ||
                    columns_.blocks[e] != columns_.blocks[is_first ? e + 1 : e - 1])
                    continue;
                if (is_tall(at, e)) continue;
            }
            const double independence = determinant(at, e, is_first, is_last, border);
            const bool is_weak = independence < kWeakDeterminant,
                       leans = moved_corners(e) < 3 &&
                               ((!is_first && leans_at(at, e - 1, kSteepFace, false)) ||
                                (!is_last && leans_at(at, e, kSteepFace, false)));
            if (!is_weak && !leans) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                if (low[i] == high[i]) continue;
                const bool upper = is_first && !is_last;  // which of its heights goes
                const std::int32_t gone = upper ? high[i] : low[i];
                const double rise = at.z(i, high[i]) - at.z(i, low[i]);
                // one alone in its column would only make its neighbor the end
                if ((independence > kNoDeterminant || (is_first && is_last)) &&
                    divides_blocks(t, i, gone) && rise >= kThickEnd * minimum_thickness_)
                    continue;
                const PillarLevels::Removal removal{plan_.corners(t)[i], gone,
                                                    upper ? low[i] : high[i]};
                const auto levels = levels_.levels(plan_.pillar(t, i));
                // one that leans is better than a neighbor without any above it
                const bool is_last_but_one = levels.back() - levels.front() == 2;
                if (is_first && is_last ? is_narrow[t] != 0 : is_weak || !is_last_but_one)
                    removals.push_back(removal);
            }
        }
    }
    return removals;
}

/// Gives up an element: its upper heights, or its lower ones.
void ElementQuality::give_up(std::size_t t, std::size_t element, bool upper,
                             Removals& removals) const {
    const LevelFront &low = columns_.fronts[element], &high = columns_.fronts[element + 1];
    for (std::size_t i = 0; i < 3; ++i) {
        if (low[i] == high[i]) continue;
        removals.push_back(
            {plan_.corners(t)[i], upper ? high[i] : low[i], upper ? low[i] : high[i]});
    }
}

std::vector<ElementBody> ElementQuality::bodies() const {
    std::vector<ElementBody> made(columns_.fronts.size());
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        const ColumnCorners at = corners(t);
        for (std::size_t e = columns_.offset[t]; e < columns_.offset[t] + columns_.elements(t); ++e)
            made[e] = body(at, e);
    }
    return made;
}

/// Visits all faces once, those between two elements from the lower one or from the triangle with
/// the lesser number.
template <class Visit>
void ElementQuality::for_faces(const Visit& visit) const {
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        if (columns_.elements(t) == 0) continue;
        const std::size_t first = columns_.offset[t], end = first + columns_.elements(t);
        const ColumnCorners at = corners(t);
        for (std::size_t e = first; e <= end; ++e) {
            const LevelFront& front = columns_.fronts[e];
            ElementFace face{{}, at.flat_area(front), {}};
            for (std::size_t i = 0; i < 4; ++i)
                face.corners[i] = at.at(i % 3, front[i % 3]);
            for (std::size_t k = 0; k < 3; ++k)
                face.center[k] = (face.corners[0][k] + face.corners[1][k] + face.corners[2][k]) / 3;
            const ElementRef below{t, e == first ? kNone : e - 1}, above{t, e == end ? kNone : e};
            if (e == first)
                visit(face, above, below);
            else
                visit(face, below, above);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = plan_.neighbor(t, i);
            const std::size_t j = (i + 1) % 3;
            if (shares_lateral_faces(t, i) && index(n) < t) continue;
            for_lateral_faces(t, i, [&](std::size_t e, bool is_shared, std::size_t beyond) {
                if (is_shared && index(n) < t) return;
                const LevelFront &low = columns_.fronts[e], &high = columns_.fronts[e + 1];
                const ElementFace face =
                    lateral_face(at.plan[i], at.plan[j], {at.z(i, low[i]), at.z(j, low[j])},
                                 {at.z(i, high[i]), at.z(j, high[j])});
                visit(face, ElementRef{t, e},
                      is_shared ? ElementRef{index(n), beyond} : ElementRef{t, kNone});
            });
        }
    }
}

ElementQuality::Removals ElementQuality::failing(std::span<const std::uint8_t> is_narrow) const {
    const std::vector<ElementBody> bodies = this->bodies();
    Removals removals;
    const auto give_up = [&](const ElementRef& place, bool upper) {
        const auto [t, e] = place;
        const LevelFront &low = columns_.fronts[e], &high = columns_.fronts[e + 1];
        if (columns_.elements(t) == 1) {
            // a thick one alone in its column stays: without it its neighbor would be the end
            const ColumnCorners at = corners(t);
            double rise = 0;
            for (std::size_t i = 0; i < 3; ++i)
                rise = std::max(rise, at.z(i, high[i]) - at.z(i, low[i]));
            if (is_narrow[t] == 0 || rise >= kThickEnd * minimum_thickness_) return;
        }
        this->give_up(t, e, upper, removals);
    };
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        const std::size_t first = columns_.offset[t], end = first + columns_.elements(t);
        const ColumnCorners at = corners(t);
        for (std::size_t e = first; e < end; ++e) {
            if (determinant(at, e, e == first, e + 1 == end, open_edges_[e]) < kWeakDeterminant)
                give_up({t, e}, e == first && e + 1 < end);  // its neighbor within takes the volume
        }
    }
    for_faces([&](const ElementFace& face, const ElementRef& owner, const ElementRef& other) {
        if (other.element == kNone) return;
        const ElementBody &a = bodies[owner.element], &b = bodies[other.element];
        if (!is_bad(face, a, b)) return;
        // the face goes, and the smaller element with it
        const bool is_owner_smaller = a.volume < b.volume;
        const auto [t, e] = is_owner_smaller ? owner : other;
        give_up({t, e}, owner.triangle == other.triangle
                            ? is_owner_smaller
                            : e == columns_.offset[t] && columns_.elements(t) > 1);
    });
    return removals;
}

ElementQuality::SkewedFaces ElementQuality::skewed(bool divided) const {
    SkewedFaces skewed;
    if (!divided) {
        find_skewed(*this, {}, skewed);
    } else {
        std::vector<std::size_t> whole;
        const ColumnFronts fronts = tetrahedra(whole);
        find_skewed({plan_, levels_, fronts, minimum_thickness_, progress_}, whole, skewed);
    }
    sort_unique(skewed.tall);
    return skewed;
}

/// The elements divided by the diagonals at the lower ends of their sides with the lesser node (as
/// divided() of addon/realmodel/core/simulation/elements.py): the corner with the greatest node
/// moves first. `whole`: the element that each is a part of.
ColumnFronts ElementQuality::tetrahedra(std::vector<std::size_t>& whole) const {
    ColumnFronts made;
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        const auto& nodes = plan_.corners(t);
        std::array<std::size_t, 3> order{0, 1, 2};
        std::ranges::sort(order, std::greater<>(), [&](std::size_t i) { return nodes[i]; });
        for (std::size_t e = columns_.offset[t]; e < columns_.offset[t + 1]; ++e) {
            LevelFront front = columns_.fronts[e];
            made.fronts.push_back(front);
            made.blocks.push_back(columns_.blocks[e]);
            whole.push_back(e);
            if (e + 1 == columns_.offset[t + 1]) continue;
            const LevelFront& high = columns_.fronts[e + 1];
            for (const std::size_t corner : order) {
                if (front[corner] == high[corner]) continue;
                front[corner] = high[corner];
                if (front == high) continue;
                made.fronts.push_back(front);
                made.blocks.push_back(columns_.blocks[e]);
                whole.push_back(e);
            }
        }
        made.offset.push_back(made.fronts.size());
    }
    return made;
}

/// @param tetrahedra_quality  the faces of these elements are looked at; of which `whole` each is a
///                            part, if it
/// is not one itself
void ElementQuality::find_skewed(const ElementQuality& tetrahedra_quality,
                                 std::span<const std::size_t> whole, SkewedFaces& skewed) const {
    const std::vector<ElementBody> bodies_of_tetrahedra = tetrahedra_quality.bodies();
    const auto whole_of = [&](std::size_t tetrahedron) {
        return whole.empty() ? tetrahedron : whole[tetrahedron];
    };
    tetrahedra_quality.for_faces([&](const ElementFace& face, const ElementRef& owner,
                                     const ElementRef& other) {
        const bool is_outer = other.element == kNone, is_lateral = face.area[2] == 0;
        const Vec3& center = bodies_of_tetrahedra[owner.element].center;
        const double skewness =
            is_outer ? outer_skewness(face, center)
                     : inner_skewness(face, center, bodies_of_tetrahedra[other.element].center);
        if (!(skewness > kMostSkewness)) return;
        const std::size_t e = whole_of(owner.element);
        if (skewness > kSkewnessLimit) {
            ++skewed.faces;
            if (is_outer && !is_lateral) skewed.tall.push_back(columns_.blocks[e]);
        }
        if (skewness > skewed.most) {
            skewed.most = skewness;
            skewed.place = face.center;
        }
        if (is_outer && !is_lateral) return;  // too tall rather than too thin
        const std::size_t next = is_outer ? e : whole_of(other.element);
        const bool is_owner_smaller = e == next || body(corners(owner.triangle), e).volume <
                                                       body(corners(other.triangle), next).volume;
        const std::size_t t = is_owner_smaller ? owner.triangle : other.triangle,
                          smaller = is_owner_smaller ? e : next;
        if (columns_.elements(t) == 1) return;
        const bool upper = is_lateral || e == next ? joins_upward(t, smaller) : is_owner_smaller;
        give_up(t, smaller, upper, skewed.removals);
    });
}

/// Whether an element that has to get thicker joins the next above it, not that below: one of its
/// own block rather than of another, the smaller one rather than the larger one.
bool ElementQuality::joins_upward(std::size_t t, std::size_t e) const {
    if (e == columns_.offset[t]) return true;
    if (e + 1 == columns_.offset[t] + columns_.elements(t)) return false;
    const bool below = columns_.blocks[e - 1] == columns_.blocks[e],
               above = columns_.blocks[e + 1] == columns_.blocks[e];
    if (below != above) return above;
    const ColumnCorners at = corners(t);
    return body(at, e + 1).volume < body(at, e - 1).volume;
}

std::vector<PillarLevels::Move> ElementQuality::steep(
    std::span<const std::uint8_t> is_asked) const {
    std::vector<PillarLevels::Move> moves;
    for (std::size_t t = 0; t < plan_.triangles(); ++t) {
        poll(progress_, t);
        const auto& nodes = plan_.corners(t);
        if (std::none_of(nodes.begin(), nodes.end(),
                         [&](std::int32_t n) { return is_asked[index(n)] != 0; }))
            continue;
        const std::size_t first = columns_.offset[t];
        const ColumnCorners at = corners(t);
        for (std::size_t e = first; e + 1 < first + columns_.elements(t); ++e) {
            if (!leans_at(at, e, kRelaxedFace, true)) continue;
            const LevelFront& face = columns_.fronts[e + 1];
            double mean = 0;
            for (std::size_t i = 0; i < 3; ++i)
                mean += at.z(i, face[i]) / 3;
            for (std::size_t i = 0; i < 3; ++i)
                moves.push_back({nodes[i], face[i], kRelaxedShare * (mean - at.z(i, face[i]))});
        }
    }
    return moves;
}

/// Whether an element is higher than its triangle is wide: it would only get worse if it became one
/// with the next.
bool ElementQuality::is_tall(const ColumnCorners& at, std::size_t element) const {
    const ElementBody solid = body(at, element);
    const double area = at.flat_area(columns_.fronts[element])[2];
    return solid.volume > area * std::sqrt(2 * area);
}

/// Whether a height is not just one between layers of one block: without it a block would lose
/// volume.
bool ElementQuality::divides_blocks(std::size_t t, std::size_t corner, std::int32_t height) const {
    const auto [below, above] = levels_.blocks_at(plan_.pillar(t, corner), plan_.rock(t), height);
    return below != above;
}

std::size_t ElementQuality::moved_corners(std::size_t element) const {
    std::size_t moved = 0;
    for (std::size_t i = 0; i < 3; ++i)
        moved += columns_.fronts[element][i] != columns_.fronts[element + 1][i];
    return moved;
}

/// Whether the line between the centers of an element and the next one leans by more than kMostLean
/// from the direction across the face between them. Asked of faces that are steeper, or flatter,
/// than an angle of this cosine.
bool ElementQuality::leans_at(const ColumnCorners& at, std::size_t below, double cosine,
                              bool steeper) const {
    const Vec3 area = at.flat_area(columns_.fronts[below + 1]);
    const double across = dot(area, area);
    if ((area[2] < cosine * std::sqrt(across)) != steeper) return false;
    const Vec3 line = minus(body(at, below + 1).center, body(at, below).center);
    return dot(line, area) < kMostLean * std::sqrt(dot(line, line) * across);
}

/// The center of an element's volume: its upright edges weigh as they are long.
ElementBody ElementQuality::ColumnCorners::body(const LevelFront& low,
                                                const LevelFront& high) const {
    std::array<Vec3, 3> from;
    std::array<double, 3> rise;
    double total = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        from[i] = at(i, low[i]);
        rise[i] = z(i, high[i]) - from[i][2];
        total += rise[i];
    }
    // integrals over a triangle of two linear functions: 1/12 of their products at different
    // corners, 1/6 at the same
    ElementBody made{};
    std::array<double, 3> share;
    for (std::size_t j = 0; j < 3; ++j)
        share[j] = rise[j] / (4 * total);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (rise[j] == 0) continue;  // two of three in tetrahedra
            const double weight = (i == j ? 2 : 1) * share[j];
            made.center[0] += weight * from[i][0];
            made.center[1] += weight * from[i][1];
            made.center[2] += weight * (from[i][2] + rise[i] / 2);
        }
    }
    const Vec3 u = minus(from[1], from[0]), v = minus(from[2], from[0]);
    made.volume = cross(u, v)[2] * total / 6;
    return made;
}

Vec3 ElementQuality::ColumnCorners::flat_area(const LevelFront& front) const {
    return times(0.5, triangle_normal(at(0, front[0]), at(1, front[1]), at(2, front[2])));
}

ElementQuality::ColumnCorners ElementQuality::corners(std::size_t t) const {
    ColumnCorners at;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t node = plan_.corners(t)[i];
        at.plan[i] = plan_.point(node);
        at.heights[i] = levels_.heights(node);
    }
    return at;
}

double ElementQuality::determinant(const ColumnCorners& at, std::size_t element, bool is_first,
                                   bool is_last, unsigned open_edges) const {
    const LevelFront &low = columns_.fronts[element], &high = columns_.fronts[element + 1];
    std::array<Vec3, 5> areas;
    std::size_t count = 0;
    if (!is_first) areas[count++] = at.flat_area(low);
    if (!is_last) areas[count++] = at.flat_area(high);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if ((open_edges >> i & 1U) != 0 || (low[i] == high[i] && low[j] == high[j])) continue;
        const Vec3 a = at.at(i, low[i]), b = at.at(j, low[j]);
        const double rise = (at.z(i, high[i]) - a[2] + at.z(j, high[j]) - b[2]) / 2;
        areas[count++] = {(b[1] - a[1]) * rise, -(b[0] - a[0]) * rise, 0};
    }
    return determinant_of(std::span(areas).first(count));
}

}  // namespace realmodel::simulation
