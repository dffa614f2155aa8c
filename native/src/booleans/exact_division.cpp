// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/exact_division.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <optional>
#include <utility>

#include "arrangement/triangulate.hpp"
#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/key_table.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "exact/space_points.hpp"

namespace realmodel::booleans {

using arrangement::Region;
using arrangement::View;
using spatial::BoxTree;

namespace {

constexpr std::size_t kFacetsAtOnce = 1 << 8;

/// A triangle as one of its corners sees it: its other corners, and its turns.
struct Sector {
    std::array<SpacePointId, 2> ends;
    std::uint8_t turns;
};

/// What is seen of points along an axis.
auto seen_along(const SpacePoints& points, std::size_t axis) {
    return [&points, axis](SpacePointId p) -> std::array<double, 2> {
        const auto& at = points.rounded(p);
        return {at[(axis + 1) % 3], at[(axis + 2) % 3]};
    };
}

std::uint8_t turns_of(const SpacePoints& points, const TriangleCorners& c) {
    unsigned turns = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto at = seen_along(points, axis);
        if (const auto turn = exact::orient2d_filter(at(c[0]), at(c[1]), at(c[2])))
            turns |= (*turn > 0 ? 1u : 2u) << 2 * axis;
    }
    return static_cast<std::uint8_t>(turns);
}

/// Whether a filter can tell that, seen along an axis, a line along an edge of a triangle has all
/// corners of another one beyond it but those that they share, which are ends of that edge.
bool is_beside(const SpacePoints& points, const TriangleCorners& triangle, std::uint8_t turns,
               const TriangleCorners& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int turn = (turns >> 2 * axis & 1) - (turns >> 2 * axis >> 1 & 1);
        if (turn == 0) continue;
        const auto at = seen_along(points, axis);
        for (std::size_t k = 0; k < 3; ++k) {
            const SpacePointId from = triangle[k], to = triangle[(k + 1) % 3];
            if (std::ranges::all_of(other, [&](SpacePointId p) {
                    return p == from || p == to ||
                           exact::orient2d_filter(at(from), at(to), at(p)) == -turn;
                }))
                return true;
        }
    }
    return false;
}

/// Whether the triangles around a point lie side by side, seen along an axis along which all turn
/// one way: each ends where another one begins, and they go round the point once. So no two of them
/// have anything in common but the point, and an edge that both have.
/// @param ends  memory for this
bool is_flat_star(const SpacePoints& points, SpacePointId middle, std::span<const Sector> star,
                  std::array<std::vector<SpacePointId>, 2>& ends) {
    unsigned turns = star.empty() ? 0 : ~0u;
    for (const Sector& sector : star)
        turns &= sector.turns;
    if (turns == 0) return false;
    const auto bit = static_cast<std::size_t>(std::countr_zero(turns));
    const std::size_t axis = (bit / 2 + 2) % 3;  // of what is above the point
    const auto is_above = [&](SpacePointId p) {
        return points.rounded(p)[axis] >= points.rounded(middle)[axis];
    };
    for (auto& some : ends)
        some.clear();
    int rounds = 0;
    for (const Sector& sector : star) {
        for (std::size_t k = 0; k < 2; ++k)
            ends[k].push_back(sector.ends[k]);
        // the half-line to one side of the point is passed from below by all that pass it
        rounds += !is_above(sector.ends[bit % 2]) && is_above(sector.ends[1 - bit % 2]);
    }
    for (auto& some : ends)
        std::sort(some.begin(), some.end());
    return rounds == 1 && ends[0] == ends[1];
}

bool is_triangle(const Region& region) {
    return region.loops.size() == 1 && region.loops[0].size() == 3;
}

}  // namespace

ExactDivision::ExactDivision(TrianglePieces& pieces, std::vector<PieceId>&& chosen,
                             const Execution& execution)
    : pieces_(pieces),
      chosen_(std::move(chosen)),
      execution_(execution),
      arrangement_(pieces.points) {
    find_candidates();
    find_meetings();
}

/// Whether a filter in doubles can tell that the corners that a piece does not share with another
/// one are on one side of the plane of that: then the two meet in what they share only.
bool ExactDivision::is_aside(const TriangleCorners& triangle, const TriangleCorners& other,
                             const exact::SideFilter& plane_of_other) const {
    int side = 0;
    for (const SpacePointId p : triangle) {
        if (has(other, p)) continue;
        const auto corner_side = plane_of_other(pieces_.points.rounded(p));
        if (!corner_side || (side != 0 && *corner_side != side)) return false;
        side = *corner_side;
    }
    return true;
}

/// Of each point whether the pieces around it meet in corners and edges that they share only: most
/// pieces that are near each other share a corner, and need no more tests.
std::vector<std::uint8_t> ExactDivision::flat_stars(std::span<const CandidatePiece> items) const {
    const SpacePoints& points = pieces_.points;
    const auto sectors = bucketize_in_any_order<Sector>(
        points.size(), (items.size() + kFacetsAtOnce - 1) / kFacetsAtOnce,
        [&](std::size_t chunk, const auto& put) {
            const std::size_t begin = chunk * kFacetsAtOnce;
            for (const CandidatePiece& item :
                 items.subspan(begin, std::min(kFacetsAtOnce, items.size() - begin))) {
                const TriangleCorners& c = item.corners;
                for (std::size_t k = 0; k < 3; ++k)
                    put(index(c[k]), Sector{{c[(k + 1) % 3], c[(k + 2) % 3]}, item.turns});
            }
        },
        execution_);
    std::vector<std::uint8_t> is_flat(points.size());
    parallel_ranges(is_flat.size(), kFacetsAtOnce, execution_,
                    [&](std::size_t begin, std::size_t end) {
                        std::array<std::vector<SpacePointId>, 2> ends;
                        for (std::size_t v = begin; v < end; ++v)
                            is_flat[v] = is_flat_star(points, SpacePointId(v), sectors[v], ends);
                    });
    return is_flat;
}

void ExactDivision::find_candidates() {
    const SpacePoints& points = pieces_.points;
    const std::size_t count = chosen_.size();
    // the tree of the inputs is that of their pieces, as long as none is divided
    std::optional<BoxTree> chosen_tree;
    if (!pieces_.are_whole() || count != pieces_.input_count()) {
        const auto box_of = [this](const PieceId& id) { return pieces_.box(pieces_[id].corners); };
        chosen_tree.emplace(transformed(chosen_, box_of), execution_);
    }
    const BoxTree& tree = chosen_tree ? *chosen_tree : pieces_.tree();
    std::vector<CandidatePiece> items(
        count);  // in the order of the tree, which has near ones together
    parallel_ranges(count, kFacetsAtOnce, execution_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            const TrianglePiece& piece = pieces_[chosen_[index(tree.number_at(place))]];
            items[place] = {piece.corners, turns_of(points, piece.corners), piece.is_fresh};
        }
    });
    const std::vector<std::uint8_t> is_flat = flat_stars(items);
    const auto filter_of = [&](const TriangleCorners& c) {
        return exact::SideFilter(points.rounded(c[0]), points.rounded(c[1]), points.rounded(c[2]));
    };
    candidates_ = collect_ranges<std::array<std::int32_t, 2>>(
        tree.leaf_count(), kFacetsAtOnce, execution_,
        [&](std::size_t begin, std::size_t end, auto& pairs) {
            std::size_t last = count;  // the pairs of a piece follow one another
            std::optional<exact::SideFilter> plane;
            tree.find_pairs(begin, end, [&](std::size_t place, std::size_t of_other) {
                const CandidatePiece &one = items[place], &other = items[of_other];
                const TriangleCorners &a = one.corners, &b = other.corners;
                if (!(one.is_fresh || other.is_fresh)) return;
                std::size_t shared = 0;
                for (const SpacePointId p : a) {
                    if (!has(b, p)) continue;
                    if (is_flat[index(p)] != 0) return;
                    ++shared;
                }
                if (shared == 3 || has_equal_corners(a) || has_equal_corners(b)) return;
                if (place != last) plane.emplace(filter_of(a));
                last = place;
                if (is_aside(b, a, *plane) || is_aside(a, b, filter_of(b)) ||
                    is_beside(points, a, one.turns, b) || is_beside(points, b, other.turns, a))
                    return;
                const std::int32_t i = tree.number_at(place), j = tree.number_at(of_other);
                const bool in_order = one.is_fresh && other.is_fresh ? i < j : one.is_fresh;
                pairs.push_back(in_order ? std::array{i, j} : std::array{j, i});
            });
        });
    parallel_sort(candidates_, std::less<>(), execution_);
}

void ExactDivision::find_meetings() {
    std::vector<std::int32_t> triangle_of(chosen_.size(), -1);
    for (const auto& pair : candidates_) {
        for (const std::int32_t i : pair)
            triangle_of[index(i)] = 0;
    }
    std::vector<TriangleCorners> corners;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        poll(execution_.progress, i);
        if (triangle_of[i] < 0) continue;
        triangle_of[i] = static_cast<std::int32_t>(corners.size());
        corners.push_back(pieces_[chosen_[i]].corners);
        piece_of_.push_back(static_cast<std::int32_t>(i));
    }
    arrangement_.add_all(corners, execution_);
    for (auto& pair : candidates_) {
        for (std::int32_t& i : pair)
            i = triangle_of[index(i)];
    }
    meetings_ = collect_ranges<Meeting>(
        candidates_.size(), kFacetsAtOnce, execution_,
        [&](std::size_t begin, std::size_t end, std::vector<Meeting>& contacts) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto met = arrangement_.intersection(candidates_[i][0], candidates_[i][1]);
                if (met && is_contact(*met)) contacts.push_back(*met);
            }
        });
}

/// Whether two triangles that intersect do so elsewhere than in what they share.
bool ExactDivision::is_contact(const Meeting& met) const {
    if (met.in_one_plane) return meet_in_plane(met.one, met.other);
    const auto &first = met.ends[0], &last = met.ends[1];
    if (first.to != kNone || last.to != kNone || first.from != last.from) return true;
    const auto is_corner = [&](std::int32_t triangle) {
        const auto& corners = arrangement_.corners(triangle);
        return std::find(corners.begin(), corners.end(), first.from) != corners.end();
    };
    return !is_corner(met.one) || !is_corner(met.other);
}

/// The same of triangles in one plane: they do not where a line along an edge parts them, on which
/// they have nothing but corners in common.
bool ExactDivision::meet_in_plane(std::int32_t one, std::int32_t other) const {
    const auto axis = arrangement_.view_of(one).first;
    const SpacePoints& points = pieces_.points;
    const auto is_within = [&](SpacePointId p, SpacePointId a, SpacePointId b) {
        return p != a && p != b && exact::compare(points, a, p) * exact::compare(points, p, b) > 0;
    };
    for (const auto& [first, second] : {std::pair(one, other), std::pair(other, one)}) {
        const TriangleCorners &a = arrangement_.corners(first), &b = arrangement_.corners(second);
        const int facing = exact::orient2d(points, axis, a[0], a[1], a[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            const SpacePointId from = a[k], to = a[(k + 1) % 3];
            std::vector<SpacePointId> on;
            bool separates = true;
            for (const SpacePointId p : b) {
                const int side = facing * exact::orient2d(points, axis, from, to, p);
                separates = separates && side <= 0;
                if (side == 0) on.push_back(p);
            }
            if (!separates) continue;
            for (const SpacePointId p : on) {
                if (is_within(p, from, to)) return true;
            }
            return on.size() == 2 && (is_within(from, on[0], on[1]) || is_within(to, on[0], on[1]));
        }
    }
    return true;
}

/// A region in triangles of its nodes.
std::vector<TriangleCorners> ExactDivision::divided(const Region& region) const {
    std::vector<arrangement::Loop> loops;
    std::vector<arrangement::Position> positions;
    const auto [axis, facing] = arrangement_.view_of(region.triangle);
    arrangement::Position normal{0, 0, 0};
    normal[axis] = facing;
    const View view(normal);
    for (const auto nodes : region.loops) {
        arrangement::Loop& loop = loops.emplace_back();
        for (const SpacePointId p : nodes) {
            positions.push_back(pieces_.points.rounded(p));
            loop.push_back({p.number(), view(positions.back())});
        }
    }
    std::vector<std::array<arrangement::LoopCorner, 3>> triangles;
    const auto point_of = [](std::int32_t node) { return SpacePointId(node); };
    arrangement::triangulate(loops, view.rounding(positions), triangles,
                             arrangement::PointTurns(pieces_.points, view, point_of));
    // corners, and two more for each hole, which a bridge joins with the outline
    assert(triangles.size() + 2 == positions.size() + 2 * (loops.size() - 1));
    return transformed(triangles, [](const auto& t) -> TriangleCorners {
        return {SpacePointId(t[0].node), SpacePointId(t[1].node), SpacePointId(t[2].node)};
    });
}

void ExactDivision::divide(const std::vector<Meeting>& at) {
    pieces_.points.reserve_intersections(at.size());  // each is an end of two segments
    for (const Meeting& met : at) {
        if (execution_.progress != nullptr) execution_.progress->check();  // points take time
        arrangement_.insert(met);
    }
    arrangement_.divide(execution_);
    divide_regions();
}

/// Of regions that coincide the first is divided, the others as that one; triangles need not be.
std::vector<ExactDivision::Copy> ExactDivision::coinciding_regions() const {
    const auto& regions = arrangement_.regions();
    std::vector<Copy> copies(regions.size());
    KeyTable table;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        poll(execution_.progress, r);
        if (is_triangle(regions[r])) continue;
        const auto outline = regions[r].loops[0];
        std::int8_t facing = 1;
        copies[r].of =
            table
                .find_or_add(arrangement::loop_hash(outline), static_cast<std::int32_t>(r),
                             [&](std::int32_t other) {
                                 facing = arrangement::facing_of(outline,
                                                                 regions[index(other)].loops[0]);
                                 return facing != 0;
                             })
                .number;
        assert(regions[index(copies[r].of)].loops.size() == regions[r].loops.size());
        copies[r].is_reversed = facing < 0;
    }
    return copies;
}

/// The pieces of all triangles, one after another: their regions in triangles, whose points that no
/// doubles are become the nearest doubles.
std::vector<std::vector<TrianglePiece>> ExactDivision::pieces_of_triangles() {
    const auto& regions = arrangement_.regions();
    const std::vector<Copy> copies = coinciding_regions();
    std::vector<std::vector<TriangleCorners>> triangles(regions.size());
    parallel_ranges(regions.size(), kFacetsAtOnce, execution_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t r = begin; r < end; ++r) {
                            if (copies[r].of == static_cast<std::int32_t>(r))
                                triangles[r] = divided(regions[r]);
                        }
                    });
    SpacePoints& points = pieces_.points;
    std::vector<SpacePointId> vertex(points.size(), kNone);
    const auto make = [&](const TriangleCorners& nodes) {
        TrianglePiece piece;
        for (std::size_t k = 0; k < 3; ++k) {
            const SpacePointId p = nodes[k];
            if (points.is_double(p)) {
                piece.corners[k] = p;
                continue;
            }
            piece.is_fresh = true;
            if (!vertex[index(p)].has_value()) vertex[index(p)] = points.add(points.rounded(p));
            piece.corners[k] = vertex[index(p)];
        }
        return piece;
    };
    std::vector<std::vector<TrianglePiece>> made(piece_of_.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        poll(execution_.progress, r);
        auto& pieces = made[index(regions.triangles[r])];
        const Copy& copy = copies[r];
        if (copy.of < 0) {
            const auto nodes = regions[r].loops[0];
            pieces.push_back(make({nodes[0], nodes[1], nodes[2]}));
            continue;
        }
        for (TriangleCorners nodes : triangles[index(copy.of)]) {
            if (copy.is_reversed) std::swap(nodes[1], nodes[2]);
            pieces.push_back(make(nodes));
        }
    }
    return made;
}

void ExactDivision::divide_regions() {
    auto made = pieces_of_triangles();
    std::vector<std::pair<PieceId, std::int32_t>> changed;  // and the triangle
    for (std::size_t t = 0; t < made.size(); ++t) {
        poll(execution_.progress, t);
        const PieceId id = piece(static_cast<std::int32_t>(t));
        const auto& before = pieces_[id];
        if (made[t].size() == 1 &&
            in_order(made[t][0].corners).first == in_order(before.corners).first)
            continue;
        std::erase_if(made[t],
                      [](const TrianglePiece& piece) { return has_equal_corners(piece.corners); });
        for (TrianglePiece& piece : made[t])
            piece.is_fresh = piece.is_fresh || before.is_fresh;
        changed.push_back({id, static_cast<std::int32_t>(t)});
    }
    std::sort(changed.begin(), changed.end());
    for (std::size_t i = 0; i < changed.size();) {
        poll(execution_.progress, i);
        const std::int32_t input = changed[i].first.input;
        std::vector<TrianglePiece> all;
        const auto old = pieces_.of(input);
        for (std::size_t k = 0; k < old.size(); ++k) {
            if (i < changed.size() &&
                changed[i].first == PieceId{input, static_cast<std::int32_t>(k)}) {
                const auto& pieces = made[index(changed[i++].second)];
                all.insert(all.end(), pieces.begin(), pieces.end());
            } else {
                all.push_back(old[k]);
            }
        }
        pieces_.replace(input, std::move(all));
    }
}

}  // namespace realmodel::booleans
