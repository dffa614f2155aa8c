// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/block_cells.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <set>

#include "base/disjoint_sets.hpp"
#include "base/parallel_counts.hpp"
#include "strata/cells/block_walls.hpp"
#include "strata/cells/distinct_positions.hpp"
#include "strata/conform/conforming.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::SpaceId;

namespace {

class BlockAssembly {
public:
    BlockAssembly(PlanArrangement& geometry, BlockOverlay& overlay,
                  const std::vector<std::int32_t>& surface_of_plane, std::optional<PlaneId> base,
                  std::int32_t first_block, int threads, const Progress* progress)
        : geometry_(geometry),
          overlay_(overlay),
          made_(overlay.construction()),
          surface_of_plane_(surface_of_plane),
          base_(base),
          first_block_(first_block),
          threads_(threads),
          progress_(progress) {}

    CellComplex assemble() {
        find_touched_triangles();
        add_touched_triangles();
        conform();
        add_parts();
        add_walls();
        add_whole_triangles();
        return std::move(complex_);
    }

private:
    WholeFace& whole(PlaneId plane) { return made_.whole[static_cast<std::size_t>(plane)]; }

    /// Calls visit(plane, its neighbours) for the triangles of all surfaces, from several threads.
    template <class Visit>
    void for_each_triangle(const Visit& visit) const {
        for (const BlockTiling& layer : overlay_.layers()) {
            parallel_ranges(layer.size(), kTriangles, threads_, progress_,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t t = begin; t < end; ++t) {
                                    auto neighbours = layer.neighbour[t];
                                    for (PlaneId& n : neighbours)
                                        n = n < 0 ? n : n + layer.first_plane;
                                    visit(layer.first_plane + static_cast<PlaneId>(t), neighbours);
                                }
                            });
        }
    }

    /// Whole triangles on whose edges vertices may lie: those looked at exactly, and the neighbours
    /// of divided ones. The others are touched by nothing.
    void find_touched_triangles() {
        is_touched_.assign(made_.whole.size(), 0);
        for_each_triangle([&](PlaneId plane, const std::array<PlaneId, 3>& neighbours) {
            const auto p = static_cast<std::size_t>(plane);
            if (made_.whole[p].below == WholeFace::kUnset) return;
            const bool touched =
                made_.is_exact[p] != 0 ||
                std::any_of(neighbours.begin(), neighbours.end(), [&](PlaneId n) {
                    return n >= 0 && made_.is_in_parts[static_cast<std::size_t>(n)] != 0;
                });
            is_touched_[p] = touched ? 1 : 0;
        });
    }

    void add_touched_triangles() {
        std::vector<PlaneId> planes;
        for (std::size_t p = 0; p < made_.whole.size(); ++p) {
            poll(progress_, p);
            if (is_touched_[p] != 0 && made_.whole[p].is_face())
                planes.push_back(static_cast<PlaneId>(p));
        }
        PolygonPool outlines;
        overlay_.add_outlines(planes, outlines);
        for (std::size_t i = 0; i < planes.size(); ++i) {
            made_.faces.add(outlines[i], planes[i], overlay_.layer_of(planes[i]),
                            whole(planes[i]).above, whole(planes[i]).below);
        }
        for (const auto& [plane, node] : made_.on_base) {
            if (is_touched_[static_cast<std::size_t>(plane)] != 0)
                made_.faces.add(overlay_.outline_of(plane), *base_, -1, node, kOutsideCell);
        }
    }

    /// Whole triangles hang together with their neighbours: on either side of one a block is thick
    /// along every edge, as bounds told or the overlay found.
    void join_whole_triangles(DisjointSets& sets) const {
        const auto join = [&](std::int32_t a, std::int32_t b) {
            if (a >= 0 && b >= 0 && block(a) == block(b)) sets.join(a, b);
        };
        for_each_triangle([&](PlaneId plane, const std::array<PlaneId, 3>& neighbours) {
            const auto p = static_cast<std::size_t>(plane);
            const WholeFace& face = made_.whole[p];
            if (face.below == WholeFace::kUnset) return;
            for (const PlaneId n : neighbours) {
                if (n <= plane) continue;
                const WholeFace& other = made_.whole[static_cast<std::size_t>(n)];
                if (other.below == WholeFace::kUnset) continue;
                join(face.above, other.above);
                join(face.below, other.below);
            }
        });
    }
    std::int32_t block(std::int32_t node) const {
        return made_.node_block[static_cast<std::size_t>(node)];
    }

    void conform() {
        const FaceList& faces = made_.faces;
        std::vector<ExtraPoint> extra;
        geometry_.forget_names();
        for (;;) {
            const PlanVertices places =
                find_plan_vertices(geometry_, faces, extra, threads_, progress_);
            CollinearEdges tracks =
                find_collinear_edges(geometry_, faces, places, extra, nullptr, threads_, progress_);
            loops_ = conform_faces(geometry_, faces, places, tracks, threads_, progress_);
            set_vertex_positions(places, loops_, threads_, progress_);
            TrackContacts contacts =
                find_contacts(geometry_, faces, made_.node_block, places, tracks, loops_,
                              overlay_.borders(), threads_, progress_);
            if (!contacts.missing.empty()) {
                extra.insert(extra.end(), contacts.missing.begin(), contacts.missing.end());
                continue;
            }
            made_.links.insert(made_.links.end(), contacts.links.begin(), contacts.links.end());
            number_cells();
            for (WallStretch& stretch : contacts.walls) {
                stretch.left = cell(stretch.left);
                stretch.right = cell(stretch.right);
            }
            is_needed_.assign(loops_.positions.size(), 0);
            for (std::size_t c = 0; c < faces.polygons.corners.size(); ++c) {
                const std::int32_t v = loops_.vertices[loops_.entries.first(c)];
                is_needed_[static_cast<std::size_t>(v)] = 1;
            }
            std::vector<std::uint8_t> may_bend(loops_.positions.size(), 0);
            for (const ExtraPoint& e : extra) {
                const auto place =
                    static_cast<std::size_t>(places.of_point[static_cast<std::size_t>(e.point)]);
                std::fill(may_bend.begin() + loops_.place_offsets[place],
                          may_bend.begin() + loops_.place_offsets[place + 1], std::uint8_t{1});
            }
            walls_ = join_walls(contacts.walls, loops_.positions, may_bend, is_needed_);
            make_distinct(geometry_, faces, places, loops_, threads_, progress_);
            return;
        }
    }

    /// Joins linked nodes to cells, numbered in order of their first node; faces know their cells
    /// from here on.
    void number_cells() {
        DisjointSets sets(made_.node_block.size());
        parallel_ranges(made_.links.size(), kLinks, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                                sets.join(made_.links[i].first, made_.links[i].second);
                        });
        join_whole_triangles(sets);
        cell_of_node_.assign(made_.node_block.size(), -1);
        for (std::size_t n = 0; n < cell_of_node_.size(); ++n) {
            poll(progress_, n);
            const auto root = static_cast<std::size_t>(sets.find(static_cast<std::int32_t>(n)));
            if (root == n) {
                cell_of_node_[n] = static_cast<std::int32_t>(complex_.cell_block.size());
                complex_.cell_block.push_back(made_.node_block[n] + first_block_);
            } else {
                cell_of_node_[n] = cell_of_node_[root];
            }
        }
        for (std::int32_t& node : made_.faces.above)
            node = cell(node);
        for (std::int32_t& node : made_.faces.below)
            node = cell(node);
    }
    std::int32_t cell(std::int32_t node) const {
        return node < 0 ? kOutsideCell : cell_of_node_[static_cast<std::size_t>(node)];
    }

    /// Faces are seen from outside the cell below, or from below where there is none.
    static void turn_outwards(std::int32_t* first, std::int32_t* last, std::int32_t& above,
                              std::int32_t& below) {
        if (below >= 0) return;
        std::reverse(first, last);
        std::swap(above, below);
    }

    /// Ends a face whose vertices were added from `begin` on, counter-clockwise seen from above (a
    /// wall: from its right).
    void end_face(std::size_t begin, std::int32_t above, std::int32_t below, std::int32_t surface) {
        auto& loop = complex_.face_vertices;
        turn_outwards(loop.begin() + begin, loop.end(), above, below);
        complex_.face_offsets.push_back(static_cast<std::int64_t>(loop.size()));
        complex_.face_cells.push_back({below, above});
        complex_.face_surface.push_back(surface);
    }

    void add_parts() {
        number_.assign(is_needed_.size(), -1);
        for (std::size_t v = 0; v < is_needed_.size(); ++v) {
            if (is_needed_[v] == 0) continue;
            number_[v] = static_cast<std::int32_t>(complex_.vertices.size());
            complex_.vertices.push_back(loops_.positions[v]);
        }
        const FaceList& faces = made_.faces;
        const auto is_kept = [&](std::int32_t v) {
            return number_[static_cast<std::size_t>(v)] >= 0;
        };
        const auto loop = loops_.vertices.begin();
        std::vector<std::size_t> first((faces.size() + kTriangles - 1) / kTriangles);
        parallel_ranges(
            faces.size(), kTriangles, threads_, progress_, [&](std::size_t begin, std::size_t end) {
                first[begin / kTriangles] = static_cast<std::size_t>(std::count_if(
                    loop + loops_.face_offsets[begin], loop + loops_.face_offsets[end], is_kept));
            });
        complex_.face_vertices.resize(count_before(first));
        complex_.face_offsets.resize(faces.size() + 1);
        complex_.face_offsets[0] = 0;
        complex_.face_cells.resize(faces.size());
        complex_.face_surface.resize(faces.size());
        parallel_ranges(
            faces.size(), kTriangles, threads_, progress_, [&](std::size_t begin, std::size_t end) {
                std::int32_t* next = complex_.face_vertices.begin() + first[begin / kTriangles];
                for (std::size_t f = begin; f < end; ++f) {
                    std::int32_t* const face = next;
                    for (auto i = loops_.face_offsets[f]; i < loops_.face_offsets[f + 1]; ++i) {
                        const std::int32_t v = loops_.vertices[i];
                        if (is_kept(v)) *next++ = number_[static_cast<std::size_t>(v)];
                    }
                    std::int32_t above = faces.above[f], below = faces.below[f];
                    turn_outwards(face, next, above, below);
                    complex_.face_cells[f] = {below, above};
                    complex_.face_surface[f] =
                        surface_of_plane_[static_cast<std::size_t>(faces.plane[f])];
                    complex_.face_offsets[f + 1] = next - complex_.face_vertices.begin();
                }
            });
    }
    void add_vertex(std::int32_t v) {
        const std::int32_t number = number_[static_cast<std::size_t>(v)];
        if (number >= 0) complex_.face_vertices.push_back(number);
    }

    void add_walls() {
        for (std::size_t w = 0; w < walls_.cells.size(); ++w) {
            const std::size_t begin = complex_.face_vertices.size();
            for (auto i = walls_.offsets[w]; i < walls_.offsets[w + 1]; ++i)
                add_vertex(walls_.vertices[static_cast<std::size_t>(i)]);
            end_face(begin, walls_.cells[w][1], walls_.cells[w][0], kWall);
        }
    }

    void add_whole_triangles() {
        // input vertices that parts have already, under the same numbers
        std::vector<std::int32_t> of_space(geometry_.space_count(), -1);
        std::vector<std::int32_t> of_base(
            base_ ? static_cast<std::size_t>(geometry_.vertex_count()) : 0, -1);
        const FaceList& faces = made_.faces;
        // several threads may say so of one vertex at once; they all write the same
        const auto set = [](std::int32_t& number, std::int32_t to) {
            std::atomic_ref(number).store(to, std::memory_order_relaxed);
        };
        parallel_ranges(
            faces.size(), kTriangles, threads_, progress_, [&](std::size_t begin, std::size_t end) {
                for (std::size_t f = begin; f < end; ++f) {
                    const auto last = static_cast<std::size_t>(faces.polygons.offsets[f + 1]);
                    for (auto corner = static_cast<std::size_t>(faces.polygons.offsets[f]);
                         corner < last; ++corner) {
                        const PointId point = faces.polygons.corners[corner].point;
                        if (point >= geometry_.vertex_count()) continue;
                        const auto v = loops_.vertices[loops_.entries.first(corner)];
                        const std::int32_t number = number_[static_cast<std::size_t>(v)];
                        if (base_ && faces.plane[f] == *base_) {
                            set(of_base[static_cast<std::size_t>(point)], number);
                            continue;
                        }
                        const SpaceId s = geometry_.corner_above(faces.plane[f], point);
                        if (s >= 0) set(of_space[static_cast<std::size_t>(s)], number);
                    }
                }
            });
        number_vertices(of_space);
        add_rest(of_space);
        const auto vertex = [&](std::int32_t& number, const std::array<double, 3>& position) {
            if (number < 0) {
                number = static_cast<std::int32_t>(complex_.vertices.size());
                complex_.vertices.push_back(position);
            }
            complex_.face_vertices.push_back(number);
        };
        for (const auto& [plane, node] : made_.on_base) {
            if (is_touched_[static_cast<std::size_t>(plane)] != 0) continue;
            const std::size_t begin = complex_.face_vertices.size();
            const double z = geometry_.space(geometry_.plane(*base_).corner[0]).z;
            for (const SpaceId s : geometry_.plane(plane).corner) {
                const auto v = geometry_.space(s).plan;
                vertex(of_base[static_cast<std::size_t>(v)],
                       {geometry_.point(v).x, geometry_.point(v).y, z});
            }
            end_face(begin, cell(node), kOutsideCell, kBase);
        }
    }

    bool is_rest(std::size_t plane) const {
        return is_touched_[plane] == 0 && made_.whole[plane].is_face();
    }

    /// Numbers the input vertices that only untouched triangles have, in their order.
    void number_vertices(std::vector<std::int32_t>& of_space) {
        auto is_new = zeros<std::uint8_t>(of_space.size(), threads_, progress_);
        parallel_ranges(
            made_.whole.size(), kTriangles, threads_, progress_,
            [&](std::size_t begin, std::size_t end) {
                for (std::size_t p = begin; p < end; ++p) {
                    if (!is_rest(p)) continue;
                    for (const SpaceId s : geometry_.plane(static_cast<PlaneId>(p)).corner)
                        mark(is_new[static_cast<std::size_t>(s)]);
                }
            });
        std::vector<std::size_t> first((of_space.size() + kVertices - 1) / kVertices);
        const auto for_new = [&](std::size_t begin, std::size_t end, const auto& visit) {
            for (std::size_t s = begin; s < end; ++s) {
                if (is_new[s] != 0 && of_space[s] < 0) visit(s);
            }
        };
        parallel_ranges(of_space.size(), kVertices, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            for_new(begin, end, [&](std::size_t) { ++first[begin / kVertices]; });
                        });
        const std::size_t before = complex_.vertices.size();
        complex_.vertices.resize(before + count_before(first));
        parallel_ranges(of_space.size(), kVertices, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            std::size_t next = before + first[begin / kVertices];
                            for_new(begin, end, [&](std::size_t s) {
                                const auto& space = geometry_.space(static_cast<SpaceId>(s));
                                const auto& at = geometry_.point(space.plan);
                                complex_.vertices[next] = {at.x, at.y, space.z};
                                of_space[s] = static_cast<std::int32_t>(next++);
                            });
                        });
    }

    /// The untouched triangles as faces.
    void add_rest(const std::vector<std::int32_t>& of_space) {
        const std::size_t planes = made_.whole.size();
        std::vector<std::size_t> first((planes + kTriangles - 1) / kTriangles);
        parallel_ranges(planes, kTriangles, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t p = begin; p < end; ++p)
                                first[begin / kTriangles] += is_rest(p) ? 1 : 0;
                        });
        const std::size_t count = count_before(first), faces = complex_.face_cells.size(),
                          corners = complex_.face_vertices.size();
        complex_.face_vertices.resize(corners + 3 * count);
        complex_.face_offsets.resize(faces + count + 1);
        complex_.face_cells.resize(faces + count);
        complex_.face_surface.resize(faces + count);
        parallel_ranges(
            planes, kTriangles, threads_, progress_, [&](std::size_t begin, std::size_t end) {
                std::size_t next = first[begin / kTriangles];
                for (std::size_t p = begin; p < end; ++p) {
                    if (!is_rest(p)) continue;
                    const auto& corner = geometry_.plane(static_cast<PlaneId>(p)).corner;
                    std::int32_t* loop = complex_.face_vertices.begin() + corners + 3 * next;
                    std::transform(corner.begin(), corner.end(), loop, [&](SpaceId s) {
                        return of_space[static_cast<std::size_t>(s)];
                    });
                    std::int32_t above = cell(made_.whole[p].above),
                                 below = cell(made_.whole[p].below);
                    turn_outwards(loop, loop + 3, above, below);
                    complex_.face_cells[faces + next] = {below, above};
                    complex_.face_surface[faces + next] = surface_of_plane_[p];
                    ++next;
                    complex_.face_offsets[faces + next] =
                        static_cast<std::int64_t>(corners + 3 * next);
                }
            });
    }

    static constexpr std::size_t kTriangles = 1 << 13, kVertices = 1 << 14, kLinks = 1 << 14;

    PlanArrangement& geometry_;
    BlockOverlay& overlay_;
    BlockConstruction& made_;
    const std::vector<std::int32_t>& surface_of_plane_;
    std::optional<PlaneId> base_;
    std::int32_t first_block_;
    int threads_;
    const Progress* progress_;
    CellComplex complex_;
    std::vector<std::uint8_t> is_touched_;  ///< for each plane
    ConformedFaces loops_;
    Walls walls_;
    std::vector<std::uint8_t> is_needed_;  ///< for each vertex of the loops
    std::vector<std::int32_t> number_;     ///< of each vertex of the loops, -1 where not needed
    std::vector<std::int32_t> cell_of_node_;
};

}  // namespace

CellComplex assemble_blocks(PlanArrangement& geometry, BlockOverlay& overlay,
                            const std::vector<std::int32_t>& surface_of_plane,
                            std::optional<PlaneId> base, std::int32_t first_block, int threads,
                            const Progress* progress) {
    return BlockAssembly(geometry, overlay, surface_of_plane, base, first_block, threads, progress)
        .assemble();
}

}  // namespace realmodel::strata
