// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/block_classification.hpp"

#include <algorithm>

#include "base/parallel_counts.hpp"
#include "strata/tile_bins.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

constexpr std::size_t kChunk = 512;

std::int32_t merged_label(std::int32_t a, std::int32_t b) {
    if (a == kNoLabel || a == b) return b;
    return b == kNoLabel ? a : kSeveral;
}

/// What a pair of triangles is to each other where they share a place in plan, for certain.
enum class Standing { kBelow, kAbove, kApart, kUnclear };

/// The same all over a triangle, from the difference of two planes at its corners.
Standing compare_at(const PlanArrangement& geometry, const exact::LineFilter& difference,
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
    if (below) return Standing::kBelow;
    return above ? Standing::kAbove : Standing::kUnclear;
}

/// Whether an edge of one triangle has all of the other beyond it, for certain: they share no place
/// in plan, not even a corner.
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
bool are_apart(const PlanArrangement& geometry, const PlanTriangle& a, const PlanTriangle& b) {
    return is_beyond(geometry, a, b) || is_beyond(geometry, b, a);
}

/// Where triangle `lower` stands against triangle `upper`, of which at least what lies in two boxes
/// counts: their difference over the common part of the boxes tells, or over either triangle.
Standing compare_over(const PlanArrangement& geometry, PlaneId lower, PlaneId upper,
                      const PlanBox& a, const PlanBox& b, double margin) {
    const exact::LineFilter d = geometry.trace_filter(lower, upper);  // lower less upper
    // Beside its origin, for the middle of large coordinates is rounded by more than these differ.
    const double low_x = std::max(a.low_x, b.low_x) - d.x0;
    const double high_x = std::min(a.high_x, b.high_x) - d.x0;
    const double low_y = std::max(a.low_y, b.low_y) - d.y0;
    const double high_y = std::min(a.high_y, b.high_y) - d.y0;
    const double x = 0.5 * (low_x + high_x), y = 0.5 * (low_y + high_y);
    // boxes of parts are those of rounded corners
    const exact::PlanReach& reach = geometry.reach();
    const double half_x = 0.5 * (high_x - low_x) + reach.point_error;
    const double half_y = 0.5 * (high_y - low_y) + reach.point_error;
    const double middle = d.a * x + d.b * y + d.c;
    const double reach_x = std::abs(x) + half_x, reach_y = std::abs(y) + half_y;
    const double error =
        d.error_a * reach_x + d.error_b * reach_y + d.error_c +
        0x1p-48 * (std::abs(d.a) * reach_x + std::abs(d.b) * reach_y + std::abs(d.c));
    const double room = std::abs(d.a) * half_x + std::abs(d.b) * half_y + error + margin;
    if (middle + room < 0) return Standing::kBelow;
    if (middle - room > 0) return Standing::kAbove;
    const Standing over_lower = compare_at(geometry, d, geometry.plane(lower).plan, margin);
    if (over_lower != Standing::kUnclear) return over_lower;
    const Standing over_upper = compare_at(geometry, d, geometry.plane(upper).plan, margin);
    if (over_upper != Standing::kUnclear) return over_upper;
    return are_apart(geometry, geometry.plane(lower).plan, geometry.plane(upper).plan)
               ? Standing::kApart
               : Standing::kUnclear;
}

}  // namespace

/// Where a place that rounding may have moved lies: 1 in a triangle for certain, -1 outside of it
/// for certain, 0 near its border.
int side_of_border(const PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& place) {
    constexpr double kRounding = 0x1p-44;  // of coordinates, far more than a middle has
    const double error = kRounding * (std::abs(place[0]) + std::abs(place[1])) + 1e-290;
    int side = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const exact::LineFilter edge =
            geometry.edge_filter(triangle[i], triangle[i + 1 < 3 ? i + 1 : 0]);
        const double u = edge.a * (place[0] - edge.x0), v = edge.b * (place[1] - edge.y0);
        const double least =
            (std::abs(edge.a) + std::abs(edge.b)) * error + 0x1p-46 * (std::abs(u) + std::abs(v));
        if (u + v < -least) return -1;
        if (!(u + v > least)) side = 0;
    }
    return side;
}

TriangleBounds bounds_of(const PlanArrangement& geometry, PlaneId plane) {
    TriangleBounds b{{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, HUGE_VAL, -HUGE_VAL};
    for (const exact::SpaceId s : geometry.plane(plane).corner) {
        const auto& vertex = geometry.space(s);
        const auto& p = geometry.point(vertex.plan);
        b.box = {std::min(b.box.low_x, p.x), std::min(b.box.low_y, p.y),
                 std::max(b.box.high_x, p.x), std::max(b.box.high_y, p.y)};
        b.low = std::min(b.low, vertex.z);
        b.high = std::max(b.high, vertex.z);
    }
    return b;
}

/// Finds the bounds of everything that meets while a surface is added.
void BlockOverlay::locate(const BlockTiling& layer) {
    surface_at_.resize(layer.size());
    whole_at_.resize(whole_.size());
    part_at_.resize(parts_.size());
    const std::size_t triangles = layer.size() + whole_.size();
    parallel_ranges(triangles + parts_.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        const LocalArrangement scope(geometry_);
                        for (std::size_t i = begin; i < end; ++i) {
                            if (i < layer.size()) {
                                const PlaneId plane = layer.first_plane + static_cast<PlaneId>(i);
                                surface_at_[i] = located(bounds_of(geometry_, plane));
                            } else if (i < triangles) {
                                const std::size_t f = i - layer.size();
                                whole_at_[f] = located(bounds_of(geometry_, whole_[f].plane));
                            } else {
                                const std::size_t f = i - triangles;
                                TriangleBounds bounds{box_of(scope, parts_.outlines[f]), 0, 0};
                                if (parts_.plane[f] >= 0) {
                                    const auto whole = bounds_of(geometry_, parts_.plane[f]);
                                    bounds.low = whole.low;
                                    bounds.high = whole.high;
                                }
                                part_at_[f] = located(bounds);
                            }
                        }
                    });
}

BlockOverlay::SurfaceTiles BlockOverlay::surface_tiles(const BlockTiling& layer) const {
    SurfaceTiles surface(tiles().size());
    for (std::size_t t = 0; t < layer.size(); ++t) {
        poll(progress_, t);
        const auto& [b, span] = surface_at_[t];
        for (std::int32_t r = span.low; r <= span.high; ++r) {
            for (std::int32_t c = span.left; c <= span.right; ++c)
                surface.include(tiles().tile(c, r), b.low, b.high);
        }
    }
    for (const PlanTriangle& t : layer.empty) {
        tiles().for_each_centre_in(corners_of(geometry_, t),
                                   [&](std::size_t tile) { surface.is_empty[tile] = 1; });
    }
    for (std::size_t tile = 0; tile < surface.low.size(); ++tile) {
        if (surface.low[tile] > surface.high[tile]) surface.is_empty[tile] = 1;
    }
    return surface;
}

BlockOverlay::EnvelopeTiles BlockOverlay::envelope_tiles() const {
    EnvelopeTiles envelope(tiles().size());
    const auto include = [&](const TileBounds& at, std::int32_t pending) {
        tiles().for_each(at.span, [&](std::size_t tile) {
            envelope.include(tile, at.bounds.low, at.bounds.high);
            envelope.label[tile] = merged_label(envelope.label[tile], pending);
        });
    };
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        poll(progress_, f);
        include(whole_at_[f], whole_[f].pending);
    }
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        if (parts_.plane[f] >= 0) include(part_at_[f], parts_.pending[f]);
    }
    return envelope;
}

/// Whether heights did not tell about a triangle: it lies beside a border, or under rock only.
bool BlockOverlay::is_to_compare(const Classified& c, std::size_t triangle) {
    return c.surface[triangle] == Classified::kUnclear &&
           (c.label[triangle] >= 0 || c.label[triangle] == kBesideBorder);
}

/// Marks tiles, from any thread.
void BlockOverlay::mark_tiles(const TileSpan& span, std::vector<std::uint8_t>& marks) const {
    tiles().for_each(span, [&](std::size_t tile) { mark(marks[tile]); });
}

void BlockOverlay::classify_surface(const BlockTiling& layer, const EnvelopeTiles& envelope,
                                    Classified& c) {
    c.surface.assign(layer.size(), Classified::kUnclear);
    c.label.assign(layer.size(), kSeveral);
    c.node.assign(layer.size(), kOutsideCell);
    const auto classify = [&](std::size_t t) {
        const auto& [b, span] = surface_at_[t];
        if (borders_.near(span)) {
            c.label[t] = kBesideBorder;  // heights in tiles tell nothing there
            return;
        }
        double low = HUGE_VAL, high = -HUGE_VAL;
        std::int32_t label = kNoLabel;
        const bool mixed = tiles().any(span, [&](std::size_t tile) {
            if (cover_[tile] == kOutsideOnly) {
                low = -HUGE_VAL;
                label = merged_label(label, kOutsideLabel);
            } else if (cover_[tile] == kSkyOnly) {
                high = HUGE_VAL;
                label = merged_label(label, kSkyLabel);
            } else {
                low = std::min(low, envelope.low[tile]);
                high = std::max(high, envelope.high[tile]);
                label = merged_label(label, envelope.label[tile]);
            }
            return label == kSeveral;
        });
        if (mixed || label == kNoLabel) return;
        c.label[t] = label;
        if (b.high + margin_ < low) {
            c.surface[t] = Classified::kBelow;
        } else if (b.low > high + margin_) {
            c.surface[t] = Classified::kGone;
        }
    };
    std::vector<std::uint8_t> is_wanted(tiles().size(), 0);
    parallel_ranges(layer.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t t = begin; t < end; ++t) {
                            classify(t);
                            if (is_to_compare(c, t)) mark_tiles(surface_at_[t].span, is_wanted);
                        }
                    });
    compare_surface(layer, is_wanted, c);
}

/// Compares triangles that heights alone do not tell about with the facets near them, plane by
/// plane.
void BlockOverlay::compare_surface(const BlockTiling& layer,
                                   const std::vector<std::uint8_t>& is_wanted, Classified& c) {
    // whole facets first, then parts
    const auto span_of = [&](std::size_t i) -> const TileSpan* {
        if (i < whole_.size()) return &whole_at_[i].span;
        const std::size_t part = i - whole_.size();
        return parts_.plane[part] >= 0 ? &part_at_[part].span : nullptr;
    };
    const TileBins bins(tiles(), is_wanted, whole_.size() + parts_.size(), span_of, threads_,
                        progress_);
    const auto point = [&](VertexId v) -> const exact::Point& { return geometry_.point(v); };
    const auto compare = [&](std::size_t t) {
        const PlaneId plane = layer.first_plane + static_cast<PlaneId>(t);
        const PlanBox& box = surface_at_[t].bounds.box;
        const TileSpan& span = surface_at_[t].span;
        // No border divides a triangle beside one: there is rock over all of it if there is over
        // its middle.
        const bool beside = c.label[t] == kBesideBorder;
        const PlanTriangle& corners = geometry_.plane(plane).plan;
        if (beside && borders_.divide(geometry_, corners, span)) return;
        const auto middle = middle_of(corners, point);
        bool below = true, above = true, covered = !beside;
        std::int32_t label = beside ? kNoLabel : c.label[t];
        const auto goes_on = [&](std::int32_t number) {
            const auto f = static_cast<std::size_t>(number);
            const bool is_whole = f < whole_.size();
            const std::size_t part = f - whole_.size();
            const PlaneId facet = is_whole ? whole_[f].plane : parts_.plane[part];
            const PlanBox& other = (is_whole ? whole_at_[f] : part_at_[part]).bounds.box;
            if (!box.meets(other)) return true;
            const Standing standing = compare_over(geometry_, plane, facet, box, other, margin_);
            if (standing == Standing::kApart) return true;
            if (beside) {
                label = merged_label(label, is_whole ? whole_[f].pending : parts_.pending[part]);
                covered =
                    covered || (is_whole &&
                                side_of_border(geometry_, geometry_.plane(facet).plan, middle) > 0);
            }
            below &= standing == Standing::kBelow;
            above &= standing == Standing::kAbove;
            return label != kSeveral && (below || above);
        };
        bins.all(span, goes_on);
        if (label == kSeveral || !covered || below == above) return;
        c.label[t] = label;
        c.surface[t] = below ? Classified::kBelow : Classified::kGone;
        if (beside) made_.is_exact[static_cast<std::size_t>(plane)] = 1;
    };
    c.is_unclear.assign(tiles().size(), 0);
    parallel_ranges(layer.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t t = begin; t < end; ++t) {
                            if (is_to_compare(c, t)) compare(t);
                            if (c.surface[t] == Classified::kUnclear)
                                mark_tiles(surface_at_[t].span, c.is_unclear);
                        }
                    });
}

void BlockOverlay::classify_facets(const BlockTiling& layer, const SurfaceTiles& surface,
                                   Classified& c) {
    const auto classify = [&](const TileBounds& at) {
        const TriangleBounds& b = at.bounds;
        double low = HUGE_VAL, high = -HUGE_VAL;
        bool any_empty = false, any_rock = false, near_unclear = false;
        const bool mixed = tiles().any(at.span, [&](std::size_t tile) {
            near_unclear |= c.is_unclear[tile] != 0;
            if (surface.is_empty[tile] != 0) {
                any_empty = true;
            } else {
                any_rock = true;
                low = std::min(low, surface.low[tile]);
                high = std::max(high, surface.high[tile]);
            }
            return any_empty && any_rock;
        });
        if (mixed) return Classified::kExact;
        if (any_empty) return near_unclear ? Classified::kExact : Classified::kKeptBare;
        if (near_unclear) return Classified::kToCompare;
        if (high + margin_ < b.low) return Classified::kClosed;
        return b.high + margin_ < low ? Classified::kKept : Classified::kToCompare;
    };
    const auto classify_whole = [&](std::size_t f) {
        const TileSpan& span = whole_at_[f].span;
        if (!borders_.near(span)) return classify(whole_at_[f]);
        const PlanTriangle& corners = geometry_.plane(whole_[f].plane).plan;
        return borders_.divide(geometry_, corners, span) ? Classified::kExact
                                                         : Classified::kToCompare;
    };
    const auto classify_part = [&](std::size_t f) {
        return parts_.plane[f] < 0 || borders_.near(part_at_[f].span) ? Classified::kExact
                                                                      : classify(part_at_[f]);
    };
    c.whole.resize(whole_.size());
    c.part.resize(parts_.size());
    std::vector<std::uint8_t> is_wanted(tiles().size(), 0);
    parallel_ranges(whole_.size() + parts_.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const bool is_whole = i < whole_.size();
                            const std::size_t f = is_whole ? i : i - whole_.size();
                            const auto facet = is_whole ? classify_whole(f) : classify_part(f);
                            (is_whole ? c.whole : c.part)[f] = facet;
                            if (facet == Classified::kToCompare)
                                mark_tiles((is_whole ? whole_at_ : part_at_)[f].span, is_wanted);
                        }
                    });
    compare_facets(layer, is_wanted, c);
}

/// Compares facets that heights alone do not tell about with the triangles near them. A facet has
/// to be looked at exactly where a triangle has to be, for the triangle's parts to be complete.
void BlockOverlay::compare_facets(const BlockTiling& layer,
                                  const std::vector<std::uint8_t>& is_wanted, Classified& c) {
    const TileBins bins(
        tiles(), is_wanted, layer.size(), [&](std::size_t t) { return &surface_at_[t].span; },
        threads_, progress_);
    const auto point = [&](VertexId v) -> const exact::Point& { return geometry_.point(v); };
    const auto compare = [&](PlaneId facet, const TileBounds& at) {
        const PlanBox& box = at.bounds.box;
        // No border divides a facet beside one: there is rock under all of it if there is under its
        // middle.
        const bool beside = borders_.near(at.span);
        const auto middle = middle_of(geometry_.plane(facet).plan, point);
        bool below = true, above = true, covers = !beside;
        const bool clear = bins.all(at.span, [&](std::int32_t t) {
            const PlaneId plane = layer.first_plane + t;
            const PlanBox& other = surface_at_[static_cast<std::size_t>(t)].bounds.box;
            if (!box.meets(other)) return true;
            if (c.surface[static_cast<std::size_t>(t)] == Classified::kUnclear)
                return are_apart(geometry_, geometry_.plane(plane).plan,
                                 geometry_.plane(facet).plan);
            const Standing standing = compare_over(geometry_, plane, facet, box, other, margin_);
            if (standing == Standing::kApart) return true;
            covers = covers || side_of_border(geometry_, geometry_.plane(plane).plan, middle) > 0;
            below &= standing == Standing::kBelow;
            above &= standing == Standing::kAbove;
            return below || above;
        });
        if (!clear || below == above || !covers) return Classified::kExact;
        if (beside) made_.is_exact[static_cast<std::size_t>(facet)] = 1;
        return below ? Classified::kClosed : Classified::kKept;
    };
    parallel_ranges(whole_.size() + parts_.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const bool is_whole = i < whole_.size();
                            const std::size_t f = is_whole ? i : i - whole_.size();
                            auto& facet = (is_whole ? c.whole : c.part)[f];
                            if (facet != Classified::kToCompare) continue;
                            facet = compare(is_whole ? whole_[f].plane : parts_.plane[f],
                                            (is_whole ? whole_at_ : part_at_)[f]);
                        }
                    });
}

}  // namespace realmodel::strata
