// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/stack.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"
#include "realmodel/base/page_store.hpp"
#include "strata/cells/block_cells.hpp"
#include "strata/cells/distinct_positions.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/conform/conforming.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/overlay/rock_footprints.hpp"
#include "strata/repair/border_joining.hpp"
#include "strata/repair/plan_snapping.hpp"
#include "strata/tiling/block_tiling.hpp"
#include "strata/tiling/rules.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// Shares of the work, measured on stacks of ten surfaces.
constexpr double kBorderShare = 0.02, kEnterShare = 0.05, kOverlayShare = 0.6, kConformShare = 0.35;

/// Begins a part of the work, counted as `share` of it.
void begin(Progress* progress, double start, double share, const char* text) {
    if (progress == nullptr) return;
    progress->check();
    progress->begin(start, start + share, text);
}

std::vector<std::array<VertexId, 3>> enter_region(PlanArrangement& geometry,
                                                  const RegionView& region,
                                                  const PlanSnapping& snapping) {
    for (const double c : region.vertices) {
        if (!std::isfinite(c))
            throw InputError("not_finite", "the region has a corner that is not a number");
    }
    std::vector<std::array<VertexId, 3>> triangles;
    for (std::size_t t = 0; t * 3 < region.triangles.size(); ++t) {
        std::array<std::array<double, 2>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto row = static_cast<std::size_t>(region.triangles[t * 3 + i]) * 2;
            if (region.triangles[t * 3 + i] < 0 || row + 1 >= region.vertices.size()) {
                throw InputError("bad_index",
                                 "a triangle of the region names a vertex that is not there", -1,
                                 {static_cast<std::int64_t>(t)});
            }
            p[i] = {snapping.x(region.vertices[row]), snapping.y(region.vertices[row + 1])};
        }
        const int turn = exact::orient2d(p[0], p[1], p[2]);
        if (turn == 0) continue;
        if (turn < 0) std::swap(p[1], p[2]);
        std::array<VertexId, 3> v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = geometry.add_vertex(p[i][0], p[i][1]);
        triangles.push_back(v);
    }
    return triangles;
}

/// Corners of a box that lies well outside of all input.
Frame enter_frame(PlanArrangement& geometry) {
    std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    for (VertexId v = 0; v < static_cast<VertexId>(geometry.point_count()); ++v) {
        const std::array<double, 2> p{geometry.point(v).x, geometry.point(v).y};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    // A power of two keeps the exact numbers short where the input is a lattice.
    const double extent = std::max({high[0] - low[0], high[1] - low[1], std::abs(high[0]) * 0x1p-30,
                                    std::abs(high[1]) * 0x1p-30, std::abs(low[0]) * 0x1p-30,
                                    std::abs(low[1]) * 0x1p-30, 1e-30});
    const double step = std::exp2(std::ceil(std::log2(extent)));
    const auto down = [&](double v) { return (std::floor(v / step) - 1.0) * step; };
    const auto up = [&](double v) { return (std::ceil(v / step) + 1.0) * step; };
    const double x0 = down(low[0]), y0 = down(low[1]), x1 = up(high[0]), y1 = up(high[1]);
    Frame frame{geometry.add_vertex(x0, y0), geometry.add_vertex(x1, y0),
                geometry.add_vertex(x1, y1), geometry.add_vertex(x0, y1)};
    // What fills the frame around long borders would all run to its corners and be near everything
    // there, were there not more vertices along its sides. Halves of halves are exact.
    const double wanted = std::sqrt(static_cast<double>(geometry.point_count())) / 8;
    const double parts = std::exp2(std::floor(std::log2(std::clamp(wanted, 1.0, 256.0))));
    for (double i = 1; i < parts; ++i) {
        const double x = x0 + (x1 - x0) * (i / parts), y = y0 + (y1 - y0) * (i / parts);
        for (const auto& p : {std::array{x, y0}, {x1, y}, {x, y1}, {x0, y}})
            frame.push_back(geometry.add_vertex(p[0], p[1]));
    }
    return frame;
}

/// A rock mass whose vertices are entered.
struct EnteredRock {
    std::int32_t first_surface = 0;  ///< counted through all rock masses
    std::vector<EnteredSurface> surfaces;
    std::vector<Rule> rules;
    std::optional<std::vector<std::array<VertexId, 3>>> region;
    std::optional<double> base_elevation;
    std::optional<PlaneId> base;
};

/// What all rock masses share while they are built.
struct Site {
    PlanArrangement geometry;
    Frame frame;
    std::vector<std::int32_t> surface_of_plane;  ///< kBase for the flat bases
    Construction construction;
    int threads = 0;
    Progress* progress = nullptr;
};

/// The layers e_k of a rock mass, handed out from the youngest to the oldest.
class TilingSequence {
public:
    TilingSequence(Site& site, EnteredRock& rock)
        : site_(site),
          rock_(rock),
          plans_(plan_surfaces(site.geometry, rock.surfaces, site.frame, site.threads,
                               site.progress)) {
        const bool plain = std::all_of(rock.rules.begin(), rock.rules.end(),
                                       [](Rule r) { return r == Rule::kErosional; });
        if (plain) return;  // e_k is the surface itself, made when it is asked for
        RuleReplay replay(site.geometry, rock.rules, site.threads, site.progress);
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            if (site.progress != nullptr) site.progress->check();
            replayed_.push_back(replay.add(surface(k)));
        }
    }

    /// Takes the outlines of a layer that was taken before and is done with: the next one may be
    /// on the same mesh.
    void give_back(SurfaceTiling layer) { similar_ = std::move(layer.polygons); }

    SurfaceTiling take(std::int32_t k) {
        if (replayed_.empty()) return surface(static_cast<std::size_t>(k));
        SurfaceTiling layer = std::move(replayed_.back());
        replayed_.pop_back();
        return layer;
    }

private:
    SurfaceTiling surface(std::size_t k) {
        const auto number = rock_.first_surface + static_cast<std::int32_t>(k);
        SurfaceTiling layer =
            make_surface_tiling(site_.geometry, rock_.surfaces[k].triangles, plans_[k], similar_,
                                number, site_.threads, site_.progress);
        rock_.surfaces[k] = {};
        plans_[k] = {};
        site_.surface_of_plane.resize(site_.geometry.plane_count(), number);
        return layer;
    }

    Site& site_;
    EnteredRock& rock_;
    std::vector<SurfacePlan> plans_;
    PolygonPool similar_;
    std::vector<SurfaceTiling> replayed_;
};

/// The lowest place of the envelope.
std::array<double, 3> lowest_place(const PlanArrangement& geometry, const Envelope& envelope) {
    LocalArrangement scope(geometry);
    std::array<double, 3> lowest{0, 0, HUGE_VAL};
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        if (envelope.plane[f] < 0) continue;
        for (const Corner& corner : envelope.outlines[f]) {
            const double z = scope.rounded_height(envelope.plane[f], corner.point);
            if (z < lowest[2]) {
                const auto [x, y] = scope.rounded(corner.point);
                lowest = {x, y, z};
            }
        }
    }
    return lowest;
}

void check_base(const std::array<double, 3>& lowest, double base, std::int32_t oldest_surface) {
    if (lowest[2] <= base) {
        throw InputError("base_not_below",
                         "base_elevation " + std::to_string(base) +
                             " is not below all of the rock mass: its lowest place is " +
                             std::to_string(lowest[2]) + " at (" + std::to_string(lowest[0]) +
                             ", " + std::to_string(lowest[1]) + "); give a lower base_elevation",
                         oldest_surface, {}, lowest);
    }
}

/// Joins the faces of a construction to a complex. Gives back what is done with on the way, so that
/// afterwards only the geometry's counts are there.
CellComplex conform(PlanArrangement& geometry, Construction& construction,
                    const std::vector<std::int32_t>& surface_of_plane, int threads,
                    Progress* progress) {
    // The peak of memory is still to come, and what chunks of overlays were made in is free.
    geometry.forget_names();
    constexpr std::size_t kManyPoints = 1000000;
    if (geometry.point_count() > kManyPoints) give_back_memory();
    std::vector<ExtraPoint> extra;
    FaceList& faces = construction.faces;
    double done = kEnterShare + kOverlayShare;
    for (int round = 0;; ++round) {
        const auto next = [&](double of_round, const char* text) {
            // a second round, where there is one, shares what is left
            const double share = of_round * kConformShare * (round == 0 ? 0.5 : 0.25);
            begin(progress, done, share, text);
            done += share;
        };
        next(0.2, "joining points");
        PlanVertices places = find_plan_vertices(geometry, faces, extra, threads, progress);
        next(0.4, "joining edges");
        CollinearEdges tracks = find_collinear_edges(
            geometry, faces, places, extra, &construction.cell_is_thick, threads, progress);
        next(0.3, "rounding");
        ConformedFaces loops = conform_faces(geometry, faces, places, tracks, threads, progress);
        next(0.1, "building walls");
        std::vector<ExtraPoint> missing;
        auto walls = find_walls(geometry, faces, tracks, loops, missing, threads, progress);
        if (!missing.empty()) {
            extra.insert(extra.end(), missing.begin(), missing.end());
            continue;
        }
        // What comes out takes the memory of what it was made of.
        tracks = {};
        loops.entries = {};
        geometry.forget_all();
        faces.layer = {};
        begin(progress, done, 1.0 - done, "putting the cells together");
        set_vertex_positions(places, loops, threads, progress);
        make_distinct(geometry, faces, places, loops, threads, progress);
        places = {};
        faces.polygons = {};
        return assemble(faces, surface_of_plane, std::move(loops), std::move(walls),
                        std::move(construction.cell_block), threads, progress);
    }
}

/// Enters the vertices of a rock mass.
EnteredRock enter_rock(PlanArrangement& geometry, const StackInput& input,
                       std::int32_t first_surface, const PlanSnapping& snapping,
                       std::vector<Warning>& warnings, int threads, const Progress* progress) {
    EnteredRock rock;
    rock.first_surface = first_surface;
    rock.rules = input.rules;
    if (input.base_elevation && !std::isfinite(*input.base_elevation)) {
        throw InputError("not_finite", "the base elevation is not a finite number", first_surface);
    }
    rock.base_elevation = input.base_elevation;
    rock.surfaces = enter_surfaces(geometry, input.surfaces, first_surface, snapping, warnings,
                                   threads, progress);
    if (input.region) rock.region = enter_region(geometry, *input.region, snapping);
    return rock;
}

/// The base of a rock mass as a plane over the frame; its heights must be there before the vertices
/// are frozen.
void enter_base(Site& site, EnteredRock& rock) {
    if (!rock.base_elevation) return;
    std::array<exact::SpaceId, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
        corner[i] = site.geometry.add_space_vertex(site.frame[i], *rock.base_elevation);
    }
    rock.base = site.geometry.add_plane(corner);
    site.surface_of_plane.resize(site.geometry.plane_count(), kBase);
}

/// Adds the cells and faces of a rock mass, going down from its youngest surface.
void build_rock(Site& site, EnteredRock& rock, double start, double share) {
    const auto first_cell = site.construction.cell_block.size();
    const auto count = static_cast<std::int32_t>(rock.surfaces.size());
    Envelope envelope;
    if (rock.region) {
        envelope = initial_envelope(
            make_region_tiling(site.geometry, *rock.region, site.frame, site.progress), -1);
    }
    TilingSequence layers(site, rock);
    for (std::int32_t k = count - 1; k >= 0; --k) {
        begin(site.progress, start + share * static_cast<double>(count - 1 - k) / count,
              share / count, "intersecting the surfaces");
        SurfaceTiling layer = layers.take(k);
        envelope = envelope.size() == 0 ? initial_envelope(layer, k)
                                        : overlay(site.geometry, envelope, layer, k,
                                                  site.construction, site.threads, site.progress);
        layers.give_back(std::move(layer));
    }
    bool is_far_above = false;
    if (rock.base) {
        const auto lowest = lowest_place(site.geometry, envelope);
        const double base = *rock.base_elevation;
        check_base(lowest, base, rock.first_surface);
        is_far_above = lowest[2] - base >
                       site.geometry.clear_height(std::max(std::abs(lowest[2]), std::abs(base)));
    }
    finish(envelope, rock.base, is_far_above, site.construction);
    auto& block = site.construction.cell_block;
    for (std::size_t c = first_cell; c < block.size(); ++c)
        block[c] += rock.first_surface;
}

/// Whether blocks of these rock masses can be built without columns.
bool is_plain(const std::vector<EnteredRock>& rocks) {
    return rocks.size() == 1 && std::all_of(rocks[0].rules.begin(), rocks[0].rules.end(),
                                            [](Rule r) { return r == Rule::kErosional; });
}

/// The blocks of a single rock mass whose surfaces are all erosional.
CellComplex build_plain_blocks(Site& site, EnteredRock& rock) {
    std::vector<SurfacePlan> plans =
        plan_surfaces(site.geometry, rock.surfaces, site.frame, site.threads, site.progress);
    std::vector<BlockTiling> layers;
    for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
        if (site.progress != nullptr) site.progress->check();
        layers.push_back(make_block_tiling(site.geometry, rock.surfaces[k].triangles,
                                           std::move(plans[k]), static_cast<std::int32_t>(k),
                                           site.threads, site.progress));
        site.surface_of_plane.resize(site.geometry.plane_count(), static_cast<std::int32_t>(k));
        rock.surfaces[k] = {};
    }
    std::optional<BlockRegion> region;
    if (rock.region) {
        region = make_block_region(site.geometry, *rock.region, site.frame, site.progress);
        rock.region.reset();
    }
    BlockOverlay overlay =
        make_block_overlay(site.geometry, layers, region, site.threads, site.progress);
    const auto count = static_cast<std::int32_t>(layers.size());
    for (std::int32_t k = count - 1; k >= 0; --k) {
        begin(site.progress,
              kEnterShare + kOverlayShare * static_cast<double>(count - 1 - k) / count,
              kOverlayShare / count, "intersecting the surfaces");
        overlay.add(k);
    }
    if (rock.base) check_base(overlay.lowest(), *rock.base_elevation, rock.first_surface);
    overlay.finish(rock.base);
    // what counts no rounds comes last: it has the other half
    begin(site.progress, kEnterShare + kOverlayShare, kConformShare / 2, "joining blocks");
    return assemble_blocks(site.geometry, overlay, site.surface_of_plane, rock.base,
                           rock.first_surface, site.threads, site.progress);
}

/// What was done to the input before it was built.
Warning joined_by_rounding(const PlanSnapping& snapping, const JoinedBorders& borders) {
    const std::size_t coordinates = snapping.x.size() + snapping.y.size();
    std::string text;
    if (coordinates > 0) {
        text = "plan coordinates that differ by rounding only taken as one: " +
               std::to_string(coordinates);
    }
    if (borders.divided > 0) {
        text += (text.empty() ? "" : "; ") +
                ("border edges divided at vertices within rounding of them: " +
                 std::to_string(borders.divided));
    }
    return {"joined", -1, {}, text};
}

CellComplex build_snapped(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                          CellKind cells, int threads, Progress* progress) {
    begin(progress, kBorderShare, kEnterShare - kBorderShare, "checking the surfaces");
    Site site;
    site.threads = threads;
    site.progress = progress;
    std::vector<Warning> warnings;
    std::vector<EnteredRock> entered;
    std::size_t vertices = 0, triangles = 0;
    for (const StackInput& rock : rocks) {
        for (const SurfaceView& surface : rock.surfaces) {
            vertices += surface.vertices.size() / 3;
            triangles += surface.triangles.size() / 3;
        }
    }
    site.geometry.expect_vertices(vertices);
    site.geometry.expect_planes(triangles + rocks.size());
    std::int32_t surfaces = 0;
    for (const StackInput& rock : rocks) {
        entered.push_back(
            enter_rock(site.geometry, rock, surfaces, snapping, warnings, threads, progress));
        surfaces += static_cast<std::int32_t>(rock.surfaces.size());
    }
    CellComplex result;
    if (site.geometry.point_count() > 0) {
        site.frame = enter_frame(site.geometry);
        for (EnteredRock& rock : entered)
            enter_base(site, rock);
        site.geometry.freeze_vertices();
        // of triangulations of these vertices, and one is crossed by a trace here and there
        if (cells == CellKind::kColumns)
            site.geometry.expect_lines(4 * site.geometry.point_count());
    }
    if (site.geometry.point_count() == 0) {
        result.face_offsets.push_back(0);
    } else if (cells == CellKind::kBlocks && is_plain(entered)) {
        result = build_plain_blocks(site, entered[0]);
    } else {
        RockFootprints footprints;
        double start = kEnterShare;
        for (EnteredRock& rock : entered) {
            const double share =
                kOverlayShare * static_cast<double>(rock.surfaces.size()) / std::max(surfaces, 1);
            const std::size_t first_face = site.construction.faces.size();
            build_rock(site, rock, start, share);
            start += share;
            if (entered.size() > 1) {
                footprints.add(site.geometry, site.construction.faces, first_face, progress);
            }
        }
        result =
            conform(site.geometry, site.construction, site.surface_of_plane, threads, progress);
    }
    result.volumes = block_volumes(result, static_cast<std::size_t>(surfaces), threads, progress);
    if (cells == CellKind::kBlocks && !is_plain(entered)) result = merge_columns(result, progress);
    result.warnings = std::move(warnings);
    result.decisions = site.geometry.all_decisions();
    result.exact_decisions = site.geometry.exact_decisions();
    begin(progress, 1.0, 0.0, "done");
    return result;
}

}  // namespace

CellComplex build_rock_masses(std::span<const StackInput> rocks, int threads, Progress* progress,
                              CellKind cells) {
    const page_store::Keeper keeper;
    if (share_one_plan(rocks)) return build_snapped(rocks, {}, cells, threads, progress);
    begin(progress, 0.0, kBorderShare, "comparing the borders");
    const PlanSnapping snapping = find_snapping(rocks, threads, progress);
    const JoinedBorders joined = join_borders(rocks, snapping, threads, progress);
    if (!snapping.empty() || joined.divided > 0) {
        try {
            CellComplex result = joined.divided > 0
                                     ? build_snapped(joined.rocks, {}, cells, threads, progress)
                                     : build_snapped(rocks, snapping, cells, threads, progress);
            result.warnings.push_back(joined_by_rounding(snapping, joined));
            return result;
        } catch (const InputError&) {
            // Whatever is wrong, what the user hears is about the input as given.
        }
    }
    return build_snapped(rocks, {}, cells, threads, progress);
}

CellComplex build_stack(const StackInput& input, int threads, Progress* progress, CellKind cells) {
    return build_rock_masses({&input, 1}, threads, progress, cells);
}

}  // namespace realmodel::strata
