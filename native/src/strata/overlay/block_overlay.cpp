// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/block_overlay.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "strata/overlay/block_classification.hpp"
#include "strata/overlay/block_facets.hpp"
#include "strata/overlay/shared_polygons.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

BlockOverlay::BlockOverlay(PlanArrangement& geometry, std::span<const BlockTiling> layers,
                           BorderEdges borders, double largest_height, int threads,
                           const Progress* progress)
    : geometry_(geometry),
      layers_(layers),
      borders_(std::move(borders)),
      // Well above what rounding moves vertices by: what bounds tell apart stays apart.
      margin_(largest_height * 0x1p-40),
      threads_(threads),
      progress_(progress),
      cover_(tiles().size(), kRock) {
    made_.whole.resize(geometry.plane_count());
    made_.is_exact.resize(geometry.plane_count(), 0);
    made_.is_in_parts.resize(geometry.plane_count(), 0);
}

std::int32_t BlockOverlay::layer_of(PlaneId plane) const {
    const auto after =
        std::upper_bound(layers_.begin(), layers_.end(), plane,
                         [](PlaneId p, const BlockTiling& layer) { return p < layer.first_plane; });
    return static_cast<std::int32_t>(after - layers_.begin()) - 1;
}

std::array<PlaneId, 3> BlockOverlay::neighbours_of(PlaneId plane) const {
    const BlockTiling& layer = layers_[static_cast<std::size_t>(layer_of(plane))];
    auto result = layer.neighbour[static_cast<std::size_t>(plane - layer.first_plane)];
    for (PlaneId& p : result) {
        if (p >= 0) p += layer.first_plane;
    }
    return result;
}

Polygon BlockOverlay::outline_of(PlaneId plane) {
    const auto outline = triangle_outline(geometry_, geometry_.plane(plane).plan);
    return {outline.begin(), outline.end()};
}

void BlockOverlay::add_outlines(std::span<const PlaneId> planes, PolygonPool& pool) {
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < planes.size() + kAhead; ++i) {
        if (i < planes.size()) {
            const auto& v = geometry_.plane(planes[i]).plan;
            for (std::size_t j = 0; j < 3; ++j)
                geometry_.prefetch_edge(v[j], v[(j + 1) % 3]);
        }
        if (i >= kAhead)
            pool.add(triangle_outline(geometry_, geometry_.plane(planes[i - kAhead]).plan));
    }
}

/// Those of triangles of one surface. The line of an edge that a triangle before has is known.
void BlockOverlay::add_outlines(const BlockTiling& layer, const std::vector<std::int32_t>& polygon,
                                SurfaceTiling& part) {
    constexpr std::size_t kAhead = 8;
    const std::size_t count = part.plane.size();
    GrowingArray<Corner>& corners = part.polygons.corners;
    const auto known = [&](std::size_t p, std::size_t i) -> const Corner* {
        const auto t = static_cast<std::size_t>(part.plane[p] - layer.first_plane);
        const std::int32_t neighbour = layer.neighbour[t][i];
        if (neighbour < 0 || static_cast<std::size_t>(neighbour) > t) return nullptr;
        const std::int32_t there = polygon[static_cast<std::size_t>(neighbour)];
        return there < 0 ? nullptr : &corners[3 * static_cast<std::size_t>(there)];
    };
    corners.reserve(3 * count);
    for (std::size_t ahead = 0; ahead < count + kAhead; ++ahead) {
        if (ahead < count) {
            const PlanTriangle& v = geometry_.plane(part.plane[ahead]).plan;
            for (std::size_t i = 0; i < 3; ++i) {
                if (known(ahead, i) == nullptr) geometry_.prefetch_edge(v[i], v[(i + 1) % 3]);
            }
        }
        if (ahead < kAhead) continue;
        const std::size_t p = ahead - kAhead;
        const PlanTriangle& v = geometry_.plane(part.plane[p]).plan;
        std::array<Corner, 3> outline;
        for (std::size_t i = 0; i < 3; ++i) {
            const PointId to = v[(i + 1) % 3];
            const Corner* other = known(p, i);
            if (other == nullptr) {
                outline[i] = {v[i], geometry_.add_edge(v[i], to)};
                continue;
            }
            while (other->point != to)
                ++other;
            outline[i] = {v[i], exact::opposite(other->line)};
        }
        part.polygons.add(outline);
    }
}

void BlockOverlay::start_region(const std::vector<PlanTriangle>& region,
                                const std::vector<PlanTriangle>& outside) {
    started_ = true;
    for (const auto& [triangles, plane] :
         {std::pair(&region, kSky), std::pair(&outside, kOutside)}) {
        for (const PlanTriangle& t : *triangles) {
            parts_.add_facet(triangle_outline(geometry_, t), plane, -1, kSkyLabel);
            tiles().for_each_centre_in(corners_of(geometry_, t),
                                       [&, kind = plane](std::size_t tile) {
                                           cover_[tile] = kind == kSky ? kSkyOnly : kOutsideOnly;
                                       });
        }
    }
}

void BlockOverlay::start_sky(const BlockTiling& layer) {
    started_ = true;
    for (const PlanTriangle& t : layer.empty) {
        parts_.add_facet(triangle_outline(geometry_, t), kSky, -1, kSkyLabel);
        tiles().for_each_centre_in(corners_of(geometry_, t),
                                   [&](std::size_t tile) { cover_[tile] = kSkyOnly; });
    }
    for (std::size_t t = 0; t < layer.size(); ++t) {
        poll(progress_, t);
        const PlaneId plane = layer.first_plane + static_cast<PlaneId>(t);
        made_.is_exact[static_cast<std::size_t>(plane)] =
            borders_.near(tiles().span(bounds_of(geometry_, plane).box)) ? 1 : 0;
        whole_.push_back({plane, layer.number, kOutsideCell});
    }
}

/// The triangles that may meet a facet looked at exactly, and where there are none at all.
SurfaceTiling BlockOverlay::needed_part(const BlockTiling& layer, Classified& c) {
    std::vector<std::uint8_t> is_needed(tiles().size(), 0);
    const auto need = [&](const TileSpan& span) {
        tiles().for_each(span, [&](std::size_t tile) { is_needed[tile] = 1; });
    };
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        if (c.whole[f] == Classified::kExact) need(whole_at_[f].span);
    }
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        if (c.part[f] == Classified::kExact && parts_.plane[f] >= 0) need(part_at_[f].span);
    }
    constexpr std::size_t kTriangles = 1 << 10;
    c.polygon.assign(layer.size(), -1);
    parallel_ranges(layer.size(), kTriangles, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t t = begin; t < end; ++t) {
                            if (c.surface[t] == Classified::kUnclear ||
                                tiles().any(surface_at_[t].span,
                                            [&](std::size_t tile) { return is_needed[tile] != 0; }))
                                c.polygon[t] = 0;
                        }
                    });
    SurfaceTiling part;
    for (std::size_t t = 0; t < layer.size(); ++t) {
        poll(progress_, t);
        if (c.polygon[t] < 0) continue;
        c.polygon[t] = static_cast<std::int32_t>(part.plane.size());
        part.plane.push_back(layer.first_plane + static_cast<PlaneId>(t));
    }
    add_outlines(layer, c.polygon, part);
    for (const PlanTriangle& t : layer.empty) {
        part.polygons.add(triangle_outline(geometry_, t));
        part.plane.push_back(kVoid);
    }
    part.index(geometry_, threads_, progress_, std::max(tiles().size(), part.plane.size()));
    return part;
}

void BlockOverlay::overlay_exactly(const BlockTiling& layer, const SurfaceTiling& part,
                                   const SurfaceTiles& surface, Classified& c) {
    std::vector<PlaneId> planes;
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        if (c.whole[f] == Classified::kExact) planes.push_back(whole_[f].plane);
    }
    PolygonPool outlines;
    add_outlines(planes, outlines);
    ExactFacets exact;
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        if (c.whole[f] != Classified::kExact) continue;
        const WholeFacet& facet = whole_[f];
        made_.is_exact[static_cast<std::size_t>(facet.plane)] = 1;
        exact.facets.add_facet(outlines[exact.facets.size()], facet.plane, layer_of(facet.plane),
                               facet.pending);
        exact.facets.add_face(outlines[exact.facets.size() - 1], facet.above);
        exact.span.push_back(whole_at_[f].span);
    }
    exact.whole = exact.facets.size();
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        if (c.part[f] != Classified::kExact) continue;
        exact.facets.add_facet_of(parts_, f, parts_.pending[f]);
        bool complete = true;
        if (parts_.plane[f] < 0) {
            complete = !tiles().any(part_at_[f].span, [&](std::size_t tile) {
                return !borders_.in_tile(tile) && surface.is_empty[tile] == 0;
            });
        }
        exact.is_complete.push_back(complete ? 1 : 0);
        exact.span.push_back(part_at_[f].span);
    }
    c.is_divided.assign(part.plane.size(), 0);
    const auto overlaid = overlay_facets(geometry_, exact, part, layer.number, borders_,
                                         c.is_divided, threads_, progress_);
    parallel_chunks(overlaid.size(), threads_, progress_, [&](std::size_t i) {
        for (PolygonPool* pool : overlaid[i]->pools())
            share(overlaid[i]->scope, *pool);
    });
    for (const auto& chunk : overlaid) {
        const auto first = static_cast<std::int32_t>(made_.node_block.size());
        const auto shared_node = [&](std::int32_t node) {
            return node == kOutsideCell ? node : node + first;
        };
        made_.node_block.insert(made_.node_block.end(), chunk->node_block.begin(),
                                chunk->node_block.end());
        std::transform(chunk->faces.below.begin(), chunk->faces.below.end(),
                       chunk->faces.below.begin(), shared_node);
        made_.faces.append(chunk->faces);
        for (const auto& closed : chunk->closed_whole) {
            made_.whole[static_cast<std::size_t>(closed.plane)] = {closed.above,
                                                                   shared_node(closed.below)};
        }
        for (const PlaneId plane : chunk->divided_whole)
            made_.is_in_parts[static_cast<std::size_t>(plane)] = 1;
        next_whole_.insert(next_whole_.end(), chunk->kept_whole.begin(), chunk->kept_whole.end());
        for (LoweredPiece piece : chunk->lowered) {
            piece.node = shared_node(piece.node);
            c.lowered.push_back(piece);
        }
        c.lowered_outlines.append(chunk->lowered_outlines);
        next_parts_.append(chunk->kept);
    }
}

/// Facets that bounds tell about.
void BlockOverlay::rest_facets(const BlockTiling& layer, Classified& c) {
    c.first_closed = static_cast<std::int32_t>(made_.node_block.size());
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        WholeFacet facet = whole_[f];
        if (c.whole[f] == Classified::kClosed) {
            made_.whole[static_cast<std::size_t>(facet.plane)] = {facet.above,
                                                                  new_node(facet.pending)};
            c.closed_whole.push_back(facet.plane);
        } else if (c.whole[f] != Classified::kExact) {
            if (c.whole[f] == Classified::kKept) facet.pending = layer.number;
            next_whole_.push_back(facet);
        }
    }
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        if (c.part[f] == Classified::kClosed) {
            const std::int32_t node = new_node(parts_.pending[f]);
            c.closed_parts.push_back(f);
            for (auto g = parts_.face_offsets[f]; g < parts_.face_offsets[f + 1]; ++g) {
                const auto face = static_cast<std::size_t>(g);
                made_.faces.add(parts_.face_polygons[face], parts_.plane[f], parts_.layer[f],
                                parts_.face_above[face], node);
            }
        } else if (c.part[f] != Classified::kExact) {
            next_parts_.add_facet_of(
                parts_, f, c.part[f] == Classified::kKept ? layer.number : parts_.pending[f]);
        }
    }
}

/// The surface's own facets.
void BlockOverlay::add_surface(const BlockTiling& layer, const SurfaceTiling& part, Classified& c) {
    constexpr std::size_t kPolygons = 1 << 10;
    for (std::size_t t = 0; t < layer.size(); ++t) {
        poll(progress_, t);
        if (c.surface[t] != Classified::kBelow) continue;
        c.node[t] = c.label[t] == kSkyLabel ? kOutsideCell : new_node(c.label[t]);
        next_whole_.push_back(
            {layer.first_plane + static_cast<PlaneId>(t), layer.number, c.node[t]});
    }
    std::vector<std::int64_t> offsets(part.plane.size() + 1, 0);
    for (const LoweredPiece& piece : c.lowered)
        ++offsets[static_cast<std::size_t>(piece.polygon) + 1];
    for (std::size_t p = 0; p < part.plane.size(); ++p)
        offsets[p + 1] += offsets[p];
    std::vector<std::size_t> of_polygon(c.lowered.size());
    {
        auto free = offsets;
        for (std::size_t i = 0; i < c.lowered.size(); ++i) {
            of_polygon[static_cast<std::size_t>(
                free[static_cast<std::size_t>(c.lowered[i].polygon)]++)] = i;
        }
    }
    const auto block_above = [&](std::size_t i) {
        const std::int32_t node = c.lowered[i].node;
        return node < 0 ? kSkyLabel : made_.node_block[static_cast<std::size_t>(node)];
    };
    std::vector<std::uint8_t> is_whole(part.plane.size(), 0);
    parallel_ranges(
        part.plane.size(), kPolygons, threads_, progress_,
        [&](std::size_t first, std::size_t last) {
            LocalArrangement scope(geometry_);
            for (std::size_t p = first; p < last; ++p) {
                const auto begin = of_polygon.begin() + offsets[p],
                           end = of_polygon.begin() + offsets[p + 1];
                if (begin == end || c.is_divided[p] != 0 || part.plane[p] < 0) continue;
                const bool alike = std::all_of(begin, end, [&](std::size_t i) {
                    return c.lowered[i].is_strict && block_above(i) == block_above(*begin);
                });
                // Where a border divides it the pieces stay apart: what stands there has its foot
                // here.
                const auto t = static_cast<std::size_t>(part.plane[p] - layer.first_plane);
                is_whole[p] =
                    alike && !borders_.divide(scope, part.polygons[p], surface_at_[t].span) ? 1 : 0;
            }
        });
    for (std::size_t t = 0; t < layer.size(); ++t) {
        if (c.polygon[t] < 0) continue;
        const auto p = static_cast<std::size_t>(c.polygon[t]);
        const auto begin = of_polygon.begin() + offsets[p],
                   end = of_polygon.begin() + offsets[p + 1];
        if (c.surface[t] == Classified::kBelow) {
            for (auto i = begin; i != end; ++i) {
                if (c.lowered[*i].node >= 0)
                    made_.links.emplace_back(c.node[t], c.lowered[*i].node);
            }
            continue;
        }
        if (begin == end || c.surface[t] == Classified::kGone) continue;
        const PlaneId plane = part.plane[p];
        made_.is_exact[static_cast<std::size_t>(plane)] = 1;
        if (is_whole[p] != 0) {
            const std::int32_t above = c.lowered[*begin].node;
            for (auto i = begin + 1; i != end && above >= 0; ++i)
                made_.links.emplace_back(above, c.lowered[*i].node);
            next_whole_.push_back({plane, layer.number, above});
            continue;
        }
        made_.is_in_parts[static_cast<std::size_t>(plane)] = 1;
        if (c.is_divided[p] == 0)
            next_parts_.add_facet(part.polygons[p], plane, layer.number, layer.number);
        for (auto i = begin; i != end; ++i) {
            if (c.is_divided[p] != 0)
                next_parts_.add_facet(c.lowered_outlines[*i], plane, layer.number, layer.number);
            next_parts_.add_face(c.lowered_outlines[*i], c.lowered[*i].node);
        }
    }
}

void BlockOverlay::add(std::int32_t number) {
    const BlockTiling& layer = layers_[static_cast<std::size_t>(number)];
    if (!started_) {
        start_sky(layer);
        return;
    }
    locate(layer);
    Classified c;
    SurfaceTiles surface(0);
    EnvelopeTiles envelope(0);
    parallel_chunks(2, threads_, progress_, [&](std::size_t which) {
        if (which == 0) {
            surface = surface_tiles(layer);
        } else {
            envelope = envelope_tiles();
        }
    });
    classify_surface(layer, envelope, c);
    classify_facets(layer, surface, c);
    next_whole_.clear();
    next_parts_ = {};
    const SurfaceTiling part = needed_part(layer, c);
    overlay_exactly(layer, part, surface, c);
    rest_facets(layer, c);
    add_surface(layer, part, c);
    link_closed(layer, c);
    for (std::size_t tile = 0; tile < cover_.size(); ++tile) {
        if (cover_[tile] == kSkyOnly && surface.is_empty[tile] == 0) cover_[tile] = kRock;
    }
    std::swap(whole_, next_whole_);
    std::swap(parts_, next_parts_);
}

void BlockOverlay::finish(std::optional<PlaneId> base) {
    for (const WholeFacet& facet : whole_) {
        std::int32_t node = kOutsideCell;
        if (base && facet.pending == 0) {
            node = new_node(0);
            made_.on_base.emplace_back(facet.plane, node);
        }
        made_.whole[static_cast<std::size_t>(facet.plane)] = {facet.above, node};
    }
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        std::int32_t node = kOutsideCell;
        if (base && parts_.pending[f] == 0) {
            node = new_node(0);
            made_.faces.add(parts_.outlines[f], *base, -1, node, kOutsideCell);
        }
        for (auto g = parts_.face_offsets[f]; g < parts_.face_offsets[f + 1]; ++g) {
            const auto face = static_cast<std::size_t>(g);
            if (node == kOutsideCell && parts_.face_above[face] == kOutsideCell) continue;
            made_.faces.add(parts_.face_polygons[face], parts_.plane[f], parts_.layer[f],
                            parts_.face_above[face], node);
        }
    }
    whole_ = {};
    parts_ = {};
    next_whole_ = {};
    next_parts_ = {};
}

std::array<double, 3> BlockOverlay::lowest() const {
    std::array<double, 3> lowest{0, 0, HUGE_VAL};
    const auto include = [&](double x, double y, double z) {
        if (z < lowest[2]) lowest = {x, y, z};
    };
    for (const WholeFacet& facet : whole_) {
        for (const exact::SpaceId s : geometry_.plane(facet.plane).corner) {
            const auto& vertex = geometry_.space(s);
            include(geometry_.point(vertex.plan).x, geometry_.point(vertex.plan).y, vertex.z);
        }
    }
    LocalArrangement scope(geometry_);
    for (std::size_t f = 0; f < parts_.size(); ++f) {
        if (parts_.plane[f] < 0) continue;
        for (const Corner& corner : parts_.outlines[f]) {
            const auto [x, y] = scope.rounded(corner.point);
            include(x, y, scope.rounded_height(parts_.plane[f], corner.point));
        }
    }
    return lowest;
}

}  // namespace realmodel::strata
