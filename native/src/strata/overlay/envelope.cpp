// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/envelope.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

void check_nodes(std::int64_t count) {
    if (count > INT32_MAX) {
        throw InputError("too_large",
                         "the model has more than 2147 million cells; use coarser surfaces");
    }
}

std::int32_t Construction::add_node(std::int32_t block, bool is_thick) {
    const auto node = static_cast<std::int64_t>(node_block.size());
    check_nodes(node + 1);
    node_block.push_back(block);
    node_is_thick.push_back(is_thick ? 1 : 0);
    return static_cast<std::int32_t>(node);
}

void Construction::seal(const Envelope& envelope, std::size_t facet, std::int32_t node) {
    const auto [begin, end] = envelope.faces_of(facet);
    for (std::size_t f = begin; f < end; ++f) {
        if (node < 0 && envelope.face_above[f] < 0) continue;
        faces.add(envelope.face_polygons[f], envelope.plane[facet], envelope.surface[facet],
                  envelope.face_above[f], node);
    }
}

void Construction::count_blocks_from(std::size_t first_node, std::int32_t first_block) {
    for (std::size_t n = first_node; n < node_block.size(); ++n)
        node_block[n] += first_block;
}

Envelope initial_envelope(const SurfaceTiling& tiling, std::int32_t number) {
    Envelope envelope;
    for (std::size_t p = 0; p < tiling.plane.size(); ++p) {
        const bool surface = tiling.plane[p].has_value();
        const PlaneId plane = tiling.plane[p] == kVoid ? kSky : tiling.plane[p];
        envelope.add_facet(tiling.polygons[p], plane, surface ? number : -1, surface ? number : -1);
        if (surface) envelope.add_face(tiling.polygons[p], kOutsideCell);
    }
    return envelope;
}

std::array<double, 3> lowest_position(const exact::PlanArrangement& geometry,
                                      const Envelope& envelope) {
    LocalArrangement scope(geometry);
    std::array<double, 3> lowest{0, 0, HUGE_VAL};
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        if (!envelope.plane[f].has_value()) continue;
        for (const Corner& corner : envelope.outlines[f]) {
            const double z = scope.rounded_height(envelope.plane[f], corner.point);
            if (z >= lowest[2]) continue;
            const auto [x, y] = scope.rounded(corner.point);
            lowest = {x, y, z};
        }
    }
    return lowest;
}

void finish(const Envelope& envelope, std::optional<PlaneId> base, bool is_thick,
            Construction& construction) {
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        std::int32_t node = kOutsideCell;
        if (base && envelope.block_beneath[f] == 0) {
            node = construction.add_node(0, is_thick);
            construction.faces.add(envelope.outlines[f], *base, -1, node, kOutsideCell);
        }
        construction.seal(envelope, f, node);
    }
}

namespace {

constexpr std::size_t kPolygons = 1 << 12, kPieces = 1 << 14;  // worked on at a time
constexpr std::size_t kAhead = 16;                             // pieces

/// How much of an envelope there is up to somewhere.
struct EnvelopeSize {
    std::size_t facets = 0, corners = 0, faces = 0, face_corners = 0;

    void add_facet(PolygonView outline) {
        ++facets;
        corners += outline.size();
    }
    void add_face(PolygonView outline) {
        ++faces;
        face_corners += outline.size();
    }
    EnvelopeSize& operator+=(const EnvelopeSize& more) {
        facets += more.facets;
        corners += more.corners;
        faces += more.faces;
        face_corners += more.face_corners;
        return *this;
    }
};

/// Writes facets and faces behind what an envelope that was made large enough has up to somewhere.
class EnvelopeWriter {
public:
    EnvelopeWriter(Envelope& envelope, const EnvelopeSize& start, std::int32_t number)
        : envelope_(envelope), at_(start), number_(number) {}

    void add_facet(PolygonView outline, PlaneId plane) {
        std::ranges::copy(outline, envelope_.outlines.corners.begin() + at_.corners);
        const std::size_t facet = at_.facets;
        at_.add_facet(outline);
        envelope_.outlines.offsets[facet + 1] = static_cast<std::uint32_t>(at_.corners);
        envelope_.plane[facet] = plane;
        envelope_.surface[facet] = number_;
        envelope_.block_beneath[facet] = number_;
        envelope_.face_offsets[facet + 1] = static_cast<std::int64_t>(at_.faces);
    }
    /// Adds a face to the facet added last.
    void add_face(PolygonView outline, std::int32_t node_above) {
        std::ranges::copy(outline, envelope_.face_polygons.corners.begin() + at_.face_corners);
        envelope_.face_above[at_.faces] = node_above;
        at_.add_face(outline);
        envelope_.face_polygons.offsets[at_.faces] = static_cast<std::uint32_t>(at_.face_corners);
        envelope_.face_offsets[at_.facets] = static_cast<std::int64_t>(at_.faces);
    }

private:
    Envelope& envelope_;
    EnvelopeSize at_;
    std::int32_t number_;
};

void resize(Envelope& envelope, const EnvelopeSize& size) {
    envelope.outlines.offsets.resize(size.facets + 1);
    envelope.outlines.corners.resize(size.corners);
    envelope.plane.resize(size.facets);
    envelope.surface.resize(size.facets);
    envelope.block_beneath.resize(size.facets);
    envelope.face_offsets.resize(size.facets + 1);
    envelope.face_polygons.offsets.resize(size.faces + 1);
    envelope.face_polygons.corners.resize(size.face_corners);
    envelope.face_above.resize(size.faces);
}

}  // namespace

PiecesOfPolygons sort_by_polygon(const PiecesBelow& below, std::size_t polygons,
                                 const Execution& execution) {
    const std::size_t count = below.polygon.size();
    PiecesOfPolygons of;
    of.offsets = zeros<std::uint32_t>(polygons + 1, execution);
    Array<std::uint32_t> number(count);
    const auto for_all = [&](const auto& visit) {
        parallel_ranges(count, kPieces, execution, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                visit(i, static_cast<std::size_t>(below.polygon[i]));
        });
    };
    for_all([&](std::size_t i, std::size_t p) { number[i] = atomic_increment(of.offsets[p]); });
    running_totals(of.offsets, UINT32_MAX, execution);
    of.pieces = Array<std::uint32_t>(count);
    for_all([&](std::size_t i, std::size_t p) {
        of.pieces[of.offsets[p] + number[i]] = static_cast<std::uint32_t>(i);
    });
    parallel_ranges(polygons, kPolygons, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            std::sort(of.pieces.begin() + of.offsets[p], of.pieces.begin() + of.offsets[p + 1]);
    });
    return of;
}

void add_surface_facets(const NumberedTiling& surface, const std::vector<std::uint8_t>& use,
                        const PiecesBelow& below, const PiecesOfPolygons& of_polygon,
                        Envelope& next, const Execution& execution) {
    const SurfaceTiling& tiling = surface.tiling;
    const std::int32_t number = surface.number;
    const std::size_t polygons = tiling.plane.size();
    assert(use.size() == polygons && of_polygon.offsets.size() == polygons + 1);
    // Says what a polygon becomes.
    const auto visit = [&](std::size_t p, const auto& add_facet, const auto& add_face) {
        const auto pieces = of_polygon[p];
        if (pieces.empty() || use[p] == kElsewhere) return;
        if (use[p] == kUndivided) {
            add_facet(tiling.polygons[p], tiling.plane[p]);
            std::int32_t least = kOutsideCell, greatest = kOutsideCell;
            for (const std::uint32_t i : pieces) {
                least = std::min(least, below.node_above[i]);
                greatest = std::max(greatest, below.node_above[i]);
            }
            if (greatest == kOutsideCell) {  // nothing above needs the pieces
                add_face(tiling.polygons[p], least);
                return;
            }
        }
        for (const std::uint32_t i : pieces) {
            if (use[p] == kDivided) add_facet(below.outlines[i], tiling.plane[p]);
            add_face(below.outlines[i], below.node_above[i]);
        }
    };
    std::vector<EnvelopeSize> start((polygons + kPolygons - 1) / kPolygons);
    parallel_ranges(polygons, kPolygons, execution, [&](std::size_t begin, std::size_t end) {
        EnvelopeSize& size = start[begin / kPolygons];
        for (std::size_t p = begin; p < end; ++p) {
            visit(
                p, [&](PolygonView o, PlaneId) { size.add_facet(o); },
                [&](PolygonView o, std::int32_t) { size.add_face(o); });
        }
    });
    EnvelopeSize total{next.size(), next.outlines.corners.size(), next.face_polygons.size(),
                       next.face_polygons.corners.size()};
    for (EnvelopeSize& size : start)
        total += std::exchange(size, total);
    check_total(std::max(total.corners, total.face_corners), UINT32_MAX);
    resize(next, total);
    parallel_ranges(polygons, kPolygons, execution, [&](std::size_t begin, std::size_t end) {
        EnvelopeWriter writer(next, start[begin / kPolygons], number);
        const std::size_t last_piece = of_polygon.offsets[end];
        for (std::size_t p = begin; p < end; ++p) {
            // its pieces lie anywhere, so those of later polygons are fetched
            for (std::size_t k = of_polygon.offsets[p] + kAhead,
                             to = of_polygon.offsets[p + 1] + kAhead;
                 k < to && k + kAhead < last_piece; ++k) {
                prefetch(below.outlines.corners.begin() +
                         below.outlines.offsets[of_polygon.pieces[k]]);
                prefetch(below.outlines.offsets.begin() + of_polygon.pieces[k + kAhead]);
                prefetch(below.node_above.begin() + of_polygon.pieces[k + kAhead]);
            }
            visit(
                p, [&](PolygonView o, PlaneId plane) { writer.add_facet(o, plane); },
                [&](PolygonView o, std::int32_t above) { writer.add_face(o, above); });
        }
    });
}

}  // namespace realmodel::strata
