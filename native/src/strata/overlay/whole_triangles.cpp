// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/whole_triangles.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// What triangles are to each other all over one, from the difference of two planes at its corners.
Comparison compare_at(const PlanArrangement& geometry, const exact::LineFilter& difference,
                      const PlanTriangle& triangle, double margin) {
    bool below = true, above = true;
    for (const VertexId v : triangle) {
        const exact::Point& p = geometry.point(v);
        const double dx = p.x - difference.x0, dy = p.y - difference.y0;
        const double value = difference.a * dx + difference.b * dy + difference.c;
        const double room = difference.error_at(dx, dy, 0) + margin;
        below &= value + room < 0;
        above &= value - room > 0;
    }
    if (below) return Comparison::kBelow;
    return above ? Comparison::kAbove : Comparison::kUnclear;
}

/// Whether an edge of one triangle has all of the other beyond it, for certain: they share no
/// position in plan, not even a corner.
bool is_beyond(const PlanArrangement& geometry, const PlanTriangle& triangle,
               const PlanTriangle& other) {
    for (std::size_t i = 0; i < 3; ++i) {
        const exact::LineFilter edge =
            geometry.edge_filter(triangle[i], triangle[i + 1 < 3 ? i + 1 : 0]);
        if (std::all_of(other.begin(), other.end(), [&](VertexId v) {
                const exact::Point& p = geometry.point(v);
                const double dx = p.x - edge.x0, dy = p.y - edge.y0;
                return edge.a * dx + edge.b * dy < -edge.error_at(dx, dy, 0);
            }))
            return true;
    }
    return false;
}

}  // namespace

bool are_apart(const PlanArrangement& geometry, PlaneId a, PlaneId b) {
    const PlanTriangle &p = geometry.plane(a).plan, &q = geometry.plane(b).plan;
    return is_beyond(geometry, p, q) || is_beyond(geometry, q, p);
}

Comparison compare_over(const PlanArrangement& geometry, PlaneId lower, PlaneId upper,
                        const PlanBox& a, const PlanBox& b, double margin) {
    const exact::LineFilter d = geometry.trace_filter(lower, upper);  // lower less upper
    // Beside its origin, for the middle of large coordinates is rounded by more than these differ.
    const double low_x = std::max(a.low_x, b.low_x) - d.x0;
    const double high_x = std::min(a.high_x, b.high_x) - d.x0;
    const double low_y = std::max(a.low_y, b.low_y) - d.y0;
    const double high_y = std::min(a.high_y, b.high_y) - d.y0;
    const double x = 0.5 * (low_x + high_x), y = 0.5 * (low_y + high_y);
    // boxes of pieces are those of rounded corners
    const exact::PlanReach& reach = geometry.reach();
    const double half_x = 0.5 * (high_x - low_x) + reach.point_error;
    const double half_y = 0.5 * (high_y - low_y) + reach.point_error;
    const double middle = d.a * x + d.b * y + d.c;
    const double reach_x = std::abs(x) + half_x, reach_y = std::abs(y) + half_y;
    const double error =
        d.error_a * reach_x + d.error_b * reach_y + d.error_c +
        0x1p-48 * (std::abs(d.a) * reach_x + std::abs(d.b) * reach_y + std::abs(d.c));
    const double room = std::abs(d.a) * half_x + std::abs(d.b) * half_y + error + margin;
    if (middle + room < 0) return Comparison::kBelow;
    if (middle - room > 0) return Comparison::kAbove;
    const Comparison over_lower = compare_at(geometry, d, geometry.plane(lower).plan, margin);
    if (over_lower != Comparison::kUnclear) return over_lower;
    const Comparison over_upper = compare_at(geometry, d, geometry.plane(upper).plan, margin);
    if (over_upper != Comparison::kUnclear) return over_upper;
    return are_apart(geometry, lower, upper) ? Comparison::kApart : Comparison::kUnclear;
}

int side_of_border(const PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& position) {
    constexpr double kRounding = 0x1p-44;  // of coordinates, far more than a middle has
    const double error = kRounding * (std::abs(position[0]) + std::abs(position[1])) + 1e-290;
    int side = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const exact::LineFilter edge =
            geometry.edge_filter(triangle[i], triangle[i + 1 < 3 ? i + 1 : 0]);
        const double u = edge.a * (position[0] - edge.x0), v = edge.b * (position[1] - edge.y0);
        const double least =
            (std::abs(edge.a) + std::abs(edge.b)) * error + 0x1p-46 * (std::abs(u) + std::abs(v));
        if (u + v < -least) return -1;
        if (!(u + v > least)) side = 0;
    }
    return side;
}

TriangleBounds bounds_of(const PlanArrangement& geometry, PlaneId plane) {
    TriangleBounds b{spatial::kNoBox, HUGE_VAL, -HUGE_VAL};
    for (const exact::SpaceId s : geometry.plane(plane).corner) {
        const auto& vertex = geometry.space(s);
        const auto& p = geometry.point(vertex.plan);
        b.box = b.box.united({p.x, p.y, p.x, p.y});
        b.low = std::min(b.low, vertex.z);
        b.high = std::max(b.high, vertex.z);
    }
    return b;
}

std::array<double, 2> middle_of(const PlanArrangement& geometry, PlaneId plane) {
    return middle_of(geometry.plane(plane).plan,
                     [&](VertexId v) -> const exact::Point& { return geometry.point(v); });
}

namespace {

constexpr std::size_t kTrianglesAtOnce = 512;

std::int32_t merged(std::int32_t a, std::int32_t b) {
    if (a == kNoBlock || a == b) return b;
    return b == kNoBlock ? a : kSeveral;
}

}  // namespace

void WholeTriangleFilter::begin(const BlockTiling& tiling) {
    tiling_ = &tiling;
    surface_tiles_ = {};
}

/// Finds where everything is, and if it is asked for the heights of facets in tiles.
void WholeTriangleFilter::locate(const FacetView& facets, bool with_heights) {
    const BlockTiling& tiling = *tiling_;
    const bool is_new = surface_tiles_.empty();
    if (is_new) surface_at.resize(tiling.size());
    facet_at.resize(facets.size());
    const std::size_t tiling_count = is_new ? tiling.size() : 0;
    parallel_ranges(tiling_count + facets.size(), kTrianglesAtOnce, execution_,
                    [&](std::size_t begin, std::size_t end) {
                        const LocalArrangement scope(geometry_);
                        const auto at = [&](const auto& list, std::size_t i) {
                            const PlaneId plane = list.plane(i);
                            if (list.is_whole(i)) return located(bounds_of(geometry_, plane));
                            TriangleBounds bounds{};
                            if (plane.has_value()) bounds = bounds_of(geometry_, plane);
                            bounds.box = box_of(scope, list.pieces[i - list.whole.size()]);
                            return located(bounds);
                        };
                        for (std::size_t i = begin; i < end; ++i) {
                            if (i < tiling_count) {
                                surface_at[i] = at(tiling, i);
                            } else {
                                facet_at[i - tiling_count] = at(facets, i - tiling_count);
                            }
                        }
                    });
    parallel_chunks(2, execution_, [&](std::size_t which) {
        if (which == 0 && is_new) measure_surface();
        if (which == 1 && with_heights) measure_facets(facets);
    });
}

void WholeTriangleFilter::measure_surface() {
    surface_tiles_.resize(tiles().size());
    is_empty.assign(tiles().size(), 0);
    for (std::size_t t = 0; t < tiling_->size(); ++t) {
        poll(execution_.progress, t);
        const TileBounds& at = surface_at[t];
        tiles().for_each(at.span,
                         [&](std::size_t tile) { surface_tiles_[tile].include(at.bounds); });
    }
    for (const PlanTriangle& t : tiling_->empty) {
        tiles().for_each_center_in(corners_of(geometry_, t),
                                   [&](std::size_t tile) { is_empty[tile] = 1; });
    }
    for (std::size_t tile = 0; tile < is_empty.size(); ++tile) {
        if (surface_tiles_[tile].low > surface_tiles_[tile].high) is_empty[tile] = 1;
    }
}

void WholeTriangleFilter::measure_facets(const FacetView& facets) {
    facet_tiles_.assign(tiles().size(), {});
    for (std::size_t f = 0; f < facets.size(); ++f) {
        poll(execution_.progress, f);
        if (!facets.plane(f).has_value()) continue;
        const auto& at = facet_at[f];
        const std::int32_t block_beneath = facets.block(f);
        tiles().for_each(at.span, [&](std::size_t tile) {
            facet_tiles_[tile].include(at.bounds);
            facet_tiles_[tile].block = merged(facet_tiles_[tile].block, block_beneath);
        });
    }
}

/// Marks tiles, from any thread.
void WholeTriangleFilter::mark_tiles(const TileSpan& span, std::vector<std::uint8_t>& marks) const {
    tiles().for_each(span, [&](std::size_t tile) { atomic_set(marks[tile]); });
}

void WholeTriangleFilter::compare(const FacetView& facets) {
    assert(tiling_ != nullptr && facets.cover.size() == tiles().size());
    locate(facets, true);
    is_same_.clear();
    if (tiling_->is_raised) {
        is_same_.resize(static_cast<std::size_t>(geometry_.plane_count()));
        for (const PlaneId plane : facets.whole)
            is_same_[index(plane)] = 1;
        for (const PlaneId plane : tiling_->whole)
            is_same_[index(plane)] |= 2;
    }
    classify_surface(facets);
    classify_facets(facets);
}

void WholeTriangleFilter::classify_surface(const FacetView& facets) {
    surface.assign(tiling_->size(), HeightRelation::kExact);
    block.assign(tiling_->size(), kSeveral);
    const auto classify = [&](std::size_t t) {
        const auto& [b, span] = surface_at[t];
        if (!is_same_.empty() && is_same_[index(tiling_->whole[t])] == 3) {
            surface[t] = HeightRelation::kAbove;
            return;
        }
        if (borders_.near(span)) {
            block[t] = kBesideBorder;  // heights in tiles decide nothing there
            return;
        }
        double low = HUGE_VAL, high = -HUGE_VAL;
        std::int32_t over = kNoBlock;
        const bool mixed = tiles().any(span, [&](std::size_t tile) {
            if (facets.cover[tile] == Cover::kNothing) {
                low = -HUGE_VAL;
                over = merged(over, kOutsideBlock);
            } else if (facets.cover[tile] == Cover::kSkyOnly) {
                high = HUGE_VAL;
                over = merged(over, kSkyBlock);
            } else {
                const TileContent& content = facet_tiles_[tile];
                low = std::min(low, content.low);
                high = std::max(high, content.high);
                over = merged(over, content.block);
            }
            return over == kSeveral;
        });
        if (mixed || over == kNoBlock) return;
        block[t] = over;
        if (b.high + margin_ < low) {
            surface[t] = HeightRelation::kBelow;
        } else if (b.low > high + margin_) {
            surface[t] = HeightRelation::kAbove;
        }
    };
    std::vector<std::uint8_t> is_wanted(tiles().size(), 0);
    parallel_for_each(tiling_->whole.size(), execution_, [&](std::size_t t) {
        classify(t);
        if (is_to_compare(t)) mark_tiles(surface_at[t].span, is_wanted);
    });
    compare_surface(facets, is_wanted);
}

/// Compares triangles that heights alone do not sort with the facets near them, plane by plane.
void WholeTriangleFilter::compare_surface(const FacetView& facets,
                                          const std::vector<std::uint8_t>& is_wanted) {
    const spatial::TileBins bins(
        tiles(), is_wanted, facets.size(),
        [&](std::size_t f) { return !facets.plane(f).has_value() ? nullptr : &facet_at[f].span; },
        execution_);
    is_unclear_.assign(tiles().size(), 0);
    parallel_for_each(tiling_->size(), execution_, [&](std::size_t t) {
        if (is_to_compare(t)) compare_triangle(facets, bins, t);
        if (surface[t] == HeightRelation::kExact) mark_tiles(surface_at[t].span, is_unclear_);
    });
}

void WholeTriangleFilter::compare_triangle(const FacetView& facets, const spatial::TileBins& bins,
                                           std::size_t t) {
    const PlaneId plane = tiling_->whole[t];
    const TriangleBounds& bounds = surface_at[t].bounds;
    const auto& span = surface_at[t].span;
    // No border divides a triangle beside one: there are facets over all of it if there is one over
    // its middle.
    const bool beside = block[t] == kBesideBorder;
    if (beside && borders_.divide(geometry_, geometry_.plane(plane).plan, span)) return;
    const auto middle = middle_of(geometry_, plane);
    bool below = true, above = true, covered = !beside;
    std::int32_t over = beside ? kNoBlock : block[t];
    bins.all(span, [&](std::int32_t number) {
        const auto f = static_cast<std::size_t>(number);
        const PlaneId other = facets.plane(f);
        const PlanBox& box = facet_at[f].bounds.box;
        if (!bounds.box.meets(box)) return true;
        const Comparison order = compare_over(geometry_, plane, other, bounds.box, box, margin_);
        if (order == Comparison::kApart) return true;
        if (beside) {
            over = merged(over, facets.block(f));
            covered =
                covered || (facets.is_whole(f) &&
                            side_of_border(geometry_, geometry_.plane(other).plan, middle) > 0);
        }
        below &= order == Comparison::kBelow;
        above &= order == Comparison::kAbove;
        return over != kSeveral && (below || above);
    });
    if (over == kSeveral || !covered || below == above) return;
    block[t] = over;
    surface[t] = below ? HeightRelation::kBelow : HeightRelation::kAbove;
}

void WholeTriangleFilter::classify_facets(const FacetView& facets) {
    facet.assign(facets.size(), HeightRelation::kExact);
    const auto by_tiles = [&](const TileBounds& at) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        bool any_empty = false, any_surface = false, near_unclear = false;
        const bool mixed = tiles().any(at.span, [&](std::size_t tile) {
            near_unclear |= is_unclear_[tile] != 0;
            if (is_empty[tile] != 0) {
                any_empty = true;
            } else {
                any_surface = true;
                low = std::min(low, surface_tiles_[tile].low);
                high = std::max(high, surface_tiles_[tile].high);
            }
            return any_empty && any_surface;
        });
        if (mixed) return HeightRelation::kExact;
        if (any_empty) return near_unclear ? HeightRelation::kExact : HeightRelation::kUncovered;
        if (near_unclear) return HeightRelation::kToCompare;
        if (high + margin_ < at.bounds.low) return HeightRelation::kAbove;
        return at.bounds.high + margin_ < low ? HeightRelation::kBelow : HeightRelation::kToCompare;
    };
    const auto classify = [&](std::size_t f) {
        const PlaneId plane = facets.plane(f);
        if (!plane.has_value()) return HeightRelation::kExact;
        if (facets.is_whole(f) && !is_same_.empty() && is_same_[index(plane)] == 3)
            return HeightRelation::kBelow;
        const TileSpan& span = facet_at[f].span;
        if (!borders_.near(span)) return by_tiles(facet_at[f]);
        const bool is_exact =
            !facets.is_whole(f) || borders_.divide(geometry_, geometry_.plane(plane).plan, span);
        return is_exact ? HeightRelation::kExact : HeightRelation::kToCompare;
    };
    std::vector<std::uint8_t> is_wanted(tiles().size(), 0);
    parallel_for_each(facets.size(), execution_, [&](std::size_t f) {
        facet[f] = classify(f);
        if (facet[f] == HeightRelation::kToCompare) mark_tiles(facet_at[f].span, is_wanted);
    });
    compare_facets(facets, is_wanted);
}

/// Compares facets that heights alone do not sort with the triangles near them. A facet has to be
/// exact where a triangle is, for the triangle's pieces to be complete.
void WholeTriangleFilter::compare_facets(const FacetView& facets,
                                         const std::vector<std::uint8_t>& is_wanted) {
    const spatial::TileBins bins(
        tiles(), is_wanted, tiling_->size(), [&](std::size_t t) { return &surface_at[t].span; },
        execution_);
    parallel_for_each(facets.size(), execution_, [&](std::size_t f) {
        if (facet[f] == HeightRelation::kToCompare)
            facet[f] = compare_facet(facets.plane(f), facet_at[f], bins);
    });
}

HeightRelation WholeTriangleFilter::compare_facet(PlaneId plane, const TileBounds& at,
                                                  const spatial::TileBins& bins) const {
    const PlanBox& box = at.bounds.box;
    // No border divides a facet beside one: there is a surface under all of it if there is under
    // its middle.
    const bool beside = borders_.near(at.span);
    const auto middle = middle_of(geometry_, plane);
    bool below = true, above = true, covers = !beside;
    const bool clear = bins.all(at.span, [&](std::int32_t number) {
        const auto t = static_cast<std::size_t>(number);
        const PlaneId triangle = tiling_->plane(t);
        const PlanBox& other = surface_at[t].bounds.box;
        if (!box.meets(other)) return true;
        if (surface[t] == HeightRelation::kExact) return are_apart(geometry_, triangle, plane);
        const Comparison order = compare_over(geometry_, triangle, plane, other, box, margin_);
        if (order == Comparison::kApart) return true;
        covers = covers || side_of_border(geometry_, geometry_.plane(triangle).plan, middle) > 0;
        below &= order == Comparison::kBelow;
        above &= order == Comparison::kAbove;
        return below || above;
    });
    if (!clear || below == above || !covers) return HeightRelation::kExact;
    return below ? HeightRelation::kAbove : HeightRelation::kBelow;
}

void WholeTriangleFilter::cover(const FacetView& facets) {
    locate(facets, false);
    surface.assign(tiling_->size(), HeightRelation::kBelow);
    facet.assign(facets.size(), HeightRelation::kExact);
    parallel_for_each(facets.size(), execution_, [&](std::size_t f) {
        const TileSpan& span = facet_at[f].span;
        if (!facets.plane(f).has_value() || borders_.near(span)) return;
        bool any_empty = false, any_surface = false;
        tiles().for_each(span, [&](std::size_t tile) {
            (is_empty[tile] != 0 ? any_empty : any_surface) = true;
        });
        if (any_empty && any_surface) return;
        facet[f] = any_empty ? HeightRelation::kUncovered : HeightRelation::kBelow;
    });
}

SurfaceTiling WholeTriangleFilter::make_exact_tiling(PlanArrangement& geometry,
                                                     const FacetView& facets, bool with_void) {
    const BlockTiling& tiling = *tiling_;
    const std::size_t triangles = tiling.whole.size();
    std::vector<std::uint8_t> is_needed(tiles().size(), 0);
    for (std::size_t f = 0; f < facets.size(); ++f) {
        if (facet[f] != HeightRelation::kExact) continue;
        if (facets.plane(f).has_value()) {
            tiles().for_each(facet_at[f].span, [&](std::size_t tile) { is_needed[tile] = 1; });
        } else if (with_void) {  // which fills the frame: only where something else may be, too
            tiles().for_each(facet_at[f].span, [&](std::size_t tile) {
                if (facets.cover[tile] != Cover::kFacets || borders_.near(tiles().span_of(tile)))
                    is_needed[tile] = 1;
            });
        }
    }
    polygon.assign(tiling.size(), -1);
    parallel_for_each(triangles, execution_, [&](std::size_t t) {
        if (surface[t] == HeightRelation::kExact ||
            tiles().any(surface_at[t].span, [&](std::size_t tile) { return is_needed[tile] != 0; }))
            polygon[t] = 0;
    });
    SurfaceTiling exact_tiling;
    for (std::size_t t = 0; t < triangles; ++t) {
        poll(execution_.progress, t);
        if (polygon[t] < 0) continue;
        polygon[t] = static_cast<std::int32_t>(exact_tiling.plane.size());
        exact_tiling.plane.push_back(tiling.whole[t]);
    }
    add_outlines(
        geometry, exact_tiling.plane.size(),
        [&](std::size_t i) { return geometry.plane(exact_tiling.plane[i]).plan; },
        exact_tiling.polygons, execution_.progress);
    for (std::size_t i = 0; i < tiling.piece_plane.size(); ++i) {
        polygon[triangles + i] = static_cast<std::int32_t>(exact_tiling.plane.size());
        exact_tiling.polygons.add(tiling.pieces[i]);
        exact_tiling.plane.push_back(tiling.piece_plane[i]);
    }
    for (const PlanTriangle& t : tiling.empty) {
        exact_tiling.polygons.add(triangle_outline(geometry, t));
        exact_tiling.plane.push_back(kVoid);
    }
    exact_tiling.index(geometry, execution_, std::max(tiles().size(), exact_tiling.plane.size()));
    return exact_tiling;
}

std::vector<std::size_t> WholeTriangleFilter::exact_facets() const {
    std::vector<std::size_t> exact;
    for (std::size_t f = 0; f < facet.size(); ++f) {
        if (facet[f] == HeightRelation::kExact) exact.push_back(f);
    }
    return exact;
}

}  // namespace realmodel::strata
