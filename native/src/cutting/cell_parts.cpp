// SPDX-License-Identifier: GPL-3.0-or-later
// What bounds the parts of cells, and which of it belongs together.
#include "cutting/cell_parts.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

#include "arrangement/polygons.hpp"
#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "cutting/shell.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

using arrangement::for_each_edge;

CellParts::CellParts(CutterOverlay& overlay, const CutterWinding& winding, const PartSides& sides,
                     Progress* progress)
    : overlay_(overlay),
      winding_(winding),
      sides_(sides),
      loses_(overlay.model().cell_block.size(), 0) {
    make_face_pieces(progress);
    begin_phase(progress, 0.68, 0.75, "joining what bounds a part");
    make_cut_faces();
    joined_.emplace(half_faces_.size());
    join_parts(progress);
    attach_hollows(progress);
    join_unseparated();
    number_parts();
    begin_phase(progress, 0.77, 0.85, "dividing faces into polygons");
    write_face_pieces(progress);
    write_cut_faces(progress);
    find_touches(progress);
}

std::int32_t CellParts::add_half_face(std::int32_t cell, std::int8_t half, std::int8_t sign,
                                      std::int32_t source) {
    if (cell < 0) return -1;
    if (half == kOn) {
        loses_[index(cell)] = 1;
        return -1;
    }
    const std::int32_t number = checked_number(half_faces_.size(), "faces of parts of cells");
    half_faces_.push_back({cell, half, sign, source});
    return number;
}

/// Notes of the cells of a face that is left out, or part of it, that they lose a part.
void CellParts::leave_out(std::size_t face) {
    for (std::size_t k = 0; k < 2; ++k) {
        const std::int32_t cell = overlay_.model().cell(face, k);
        if (cell >= 0) loses_[index(cell)] = 1;
    }
}

/// Adds a face piece with a half-face for each of its face's cells; nothing where it is left out.
void CellParts::add_face_piece(FacePiece face_piece) {
    const auto face = index(face_piece.face);
    if (face_piece.half == kOn) {
        leave_out(face);
        return;
    }
    const auto number = static_cast<std::int32_t>(face_pieces_.size());
    for (std::size_t k = 0; k < 2; ++k)
        face_piece.half_faces[k] =
            add_half_face(overlay_.model().cell(face, k), face_piece.half, k == 0 ? 1 : -1, number);
    face_pieces_.push_back(face_piece);
}

/// Joins the regions of faces along edges that are none of the cutter's, of one face after another
/// in the same memory.
class CellParts::FaceDivider {
public:
    FaceDivider(const CutterOverlay& overlay, const CutterWinding& winding)
        : overlay_(overlay), winding_(winding) {}

    void divide(std::int32_t face, std::span<const std::int32_t> regions, DividedFaces& divided) {
        joined_.clear();
        for (std::size_t i = 0; i < regions.size(); ++i) {
            for (const auto loop : overlay_.loops(index(regions[i])))
                joined_.add(loop, static_cast<std::int32_t>(i));
        }
        joined_.pair([this](const std::array<NodeId, 2>& edge, std::int32_t, std::int32_t) {
            return !winding_.is_edge(edge);
        });
        DisjointSets joined_regions(regions.size());
        joined_.for_each_pair([&](std::int32_t i, std::int32_t j) { joined_regions.join(i, j); });
        // face pieces in the order of their outlines, which may take turns
        face_piece_of_.assign(regions.size(), -1);  // by the first region of each
        outlines_.clear();
        edges_.clear();
        std::int32_t count = 0;
        joined_.for_each_outline(
            [&](std::span<const arrangement::JoinedPolygons::PolygonHalfEdge> outline) {
                std::int32_t& face_piece =
                    face_piece_of_[index(joined_regions.find(outline[0].polygon))];
                if (face_piece < 0) face_piece = count++;
                outlines_.push_back({face_piece, edges_.size(), outline.size()});
                edges_.insert(edges_.end(), outline.begin(), outline.end());
            });
        std::ranges::stable_sort(outlines_, {}, &Outline::face_piece);
        regions_.clear();
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const std::int32_t face_piece =
                face_piece_of_[index(joined_regions.find(static_cast<std::int32_t>(i)))];
            if (face_piece >= 0) regions_.push_back({face_piece, regions[i]});
        }
        std::ranges::stable_sort(regions_, {}, &std::pair<std::int32_t, std::int32_t>::first);
        auto outline = outlines_.begin();
        auto region = regions_.begin();
        for (std::int32_t face_piece = 0; face_piece < count; ++face_piece) {
            for (; outline != outlines_.end() && outline->face_piece == face_piece; ++outline) {
                for (const auto& edge : std::span(edges_).subspan(outline->begin, outline->size)) {
                    divided.loops.nodes.push_back(edge.from);
                    divided.beside.push_back(regions[index(edge.polygon)]);
                }
                divided.loops.end_loop();
            }
            divided.loops.end_region();
            for (; region != regions_.end() && region->first == face_piece; ++region)
                divided.regions.push_back(region->second);
            divided.region_begins.push_back(divided.regions.size());
            divided.face.push_back(face);
        }
    }

private:
    struct Outline {
        std::int32_t face_piece;
        std::size_t begin, size;  ///< in `edges_`
    };

    const CutterOverlay& overlay_;
    const CutterWinding& winding_;
    arrangement::JoinedPolygons joined_;
    std::vector<std::int32_t> face_piece_of_;
    std::vector<Outline> outlines_;
    std::vector<arrangement::JoinedPolygons::PolygonHalfEdge> edges_;
    std::vector<std::pair<std::int32_t, std::int32_t>>
        regions_;  ///< the face piece and each of its
};

/// Active faces are divided on all threads; face pieces are numbered in the order of faces.
void CellParts::make_face_pieces(Progress* progress) {
    const ComplexView& model = overlay_.model();
    const auto of_face = bucketize<std::int32_t>(model.face_count(), [this](const auto& put) {
        for (std::size_t r = 0; r < overlay_.size(); ++r) {
            if (!overlay_.of_cutter(r) && winding_.coincident(r) < 0)
                put(overlay_.face_of(r), static_cast<std::int32_t>(r));
        }
    });
    const auto& active = overlay_.active_faces();
    constexpr std::size_t kChunk = 1 << 8;
    divided_.resize((active.size() + kChunk - 1) / kChunk);
    parallel_ranges(
        active.size(), kChunk, {overlay_.threads(), progress},
        [&](std::size_t begin, std::size_t end) {
            FaceDivider divider(overlay_, winding_);
            for (std::size_t i = begin; i < end; ++i)
                divider.divide(active[i], of_face[index(active[i])], divided_[begin / kChunk]);
        },
        1.0);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        const auto face = static_cast<std::int32_t>(f);
        if (!overlay_.is_active(f)) {
            add_face_piece({face, sides_.of_face(f)});
            continue;
        }
        const std::int32_t first = overlay_.first_same(f);
        const auto position = std::ranges::lower_bound(active, first) - active.begin();
        const DividedFaces& divided = divided_[static_cast<std::size_t>(position) / kChunk];
        const auto [begin, end] = std::equal_range(divided.face.begin(), divided.face.end(), first);
        for (auto face_piece = begin; face_piece != end; ++face_piece) {
            const auto number = static_cast<std::size_t>(face_piece - divided.face.begin());
            const auto region = index(divided.regions_of(number)[0]);
            add_face_piece({face, sides_.of_region(region, f), &divided, number});
        }
    }
}

/// Calls visit(use) for all edges of the half-faces of cells that reach the cutter.
template <class Visit>
void CellParts::for_each_use(const FacePiece& face_piece, const Visit& visit) const {
    for (const std::int32_t half_face : face_piece.half_faces) {
        if (half_face < 0 || !sides_.reaches(half_faces_[index(half_face)].cell)) continue;
        const HalfFace& bound = half_faces_[index(half_face)];
        if (face_piece.divided == nullptr) {
            const auto face = index(face_piece.face);
            const FarFaces& far = overlay_.far();
            for_each_edge(std::array{overlay_.model().face(face)},
                          static_cast<std::int32_t>(overlay_.size() + face),
                          [&](const EdgeUse& use) {
                              if (far.group(face) < 0 || !far.is_beyond(use.key()))
                                  visit(HalfFaceUse{bound.cell, bound.half, use, half_face});
                          });
            continue;
        }
        std::size_t edge = 0;
        const auto loops = face_piece.loops();
        const std::size_t first =
            static_cast<std::size_t>(loops[0].data() - face_piece.divided->loops.nodes.data());
        for_each_edge(loops, 0, [&](EdgeUse use) {
            use.item = face_piece.divided->beside[first + edge++];
            visit(HalfFaceUse{bound.cell, bound.half, use, half_face});
        });
    }
}

template <class Visit>
void CellParts::for_each_use(const CutFaces& cut_faces, const Visit& visit) const {
    for (const auto& of_side : cut_faces.half_faces) {
        for (const std::int32_t half_face : of_side) {
            const HalfFace& bound = half_faces_[index(half_face)];
            if (!sides_.reaches(bound.cell)) continue;
            if (cut_faces.component >= 0) {
                for (const UndividedBorder& border : winding_.borders(index(cut_faces.component)))
                    visit(HalfFaceUse{bound.cell, bound.half, border.use, half_face});
                continue;
            }
            for_each_edge(overlay_.loops(index(cut_faces.region)), cut_faces.region,
                          [&](const EdgeUse& use) {
                              visit(HalfFaceUse{bound.cell, bound.half, use, half_face});
                          });
        }
    }
}

void CellParts::collect_uses(Progress* progress) {
    constexpr std::size_t kChunk = 1 << 10;
    const std::size_t count = face_pieces_.size() + cut_faces_.size();
    uses_ = sorted_in_buckets<HalfFaceUse>(
        overlay_.node_count(), (count + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            const auto visit = [&put](const HalfFaceUse& use) { put(index(use.use.edge[0]), use); };
            for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
                if (i < face_pieces_.size()) {
                    for_each_use(face_pieces_[i], visit);
                } else {
                    for_each_use(cut_faces_[i - face_pieces_.size()], visit);
                }
            }
        },
        {overlay_.threads(), progress});
}

void CellParts::make_cut_faces() {
    const UndividedTriangles& undivided = overlay_.undivided();
    std::vector<std::int32_t> cut_faces_of(undivided.components(), -1);
    std::int32_t next = 0;  // triangle of the cutter
    const auto add_undivided_until = [&](std::int32_t end) {
        for (; undivided.components() > 0 && next < end; ++next) {
            if (undivided.has(next)) add_cut_faces_of_undivided(next, cut_faces_of);
        }
    };
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!winding_.counts(r) || !winding_.touches_model(r)) continue;
        add_undivided_until(overlay_.cutter_triangle(r));
        add_cut_faces(static_cast<std::int32_t>(r), -1);
        cut_facets_.push_back({cut_faces_.size() - 1, -1});
    }
    add_undivided_until(static_cast<std::int32_t>(overlay_.cutter().triangles.size()));
}

/// @param cut_faces_of  of components, -1 none yet
void CellParts::add_cut_faces_of_undivided(std::int32_t triangle,
                                           std::vector<std::int32_t>& cut_faces_of) {
    const std::int32_t component = overlay_.undivided().component(triangle);
    const std::int32_t region = winding_.borders(index(component))[0].region;
    if (!winding_.touches_model(index(region))) return;
    std::int32_t& cut_faces = cut_faces_of[index(component)];
    if (cut_faces < 0) {
        cut_faces = static_cast<std::int32_t>(cut_faces_.size());
        add_cut_faces(region, component);
    }
    cut_facets_.push_back({index(cut_faces), triangle});
}

void CellParts::add_cut_faces(std::int32_t region, std::int32_t component) {
    CutFaces& cut_faces = cut_faces_.emplace_back(CutFaces{region, component, {}, {}, {}});
    const auto source = -static_cast<std::int32_t>(cut_faces_.size());
    for (std::size_t k = 0; k < 2; ++k) {
        for (const auto& [cell, times] : winding_.around(index(region), k)) {
            const std::int8_t half = sides_.of_cut_face(index(region), k, cell);
            for (int i = 0; i < std::abs(times); ++i) {
                const std::int32_t half_face =
                    add_half_face(cell, half, (times > 0) == (k == 0) ? 1 : -1, source);
                if (half_face >= 0) cut_faces.half_faces[k].push_back(half_face);
            }
        }
    }
    pair_cut_faces(cut_faces);
}

/// Calls visit(loops) for the region of cut faces, or for each of the undivided triangles.
template <class Visit>
void CellParts::visit_cut_face_loops(const CutFaces& cut_faces, const Visit& visit) const {
    if (cut_faces.component < 0) {
        visit(overlay_.loops(index(cut_faces.region)));
        return;
    }
    for (const std::int32_t t : overlay_.undivided().triangles(index(cut_faces.component)))
        visit(std::array<std::array<NodeId, 3>, 1>{overlay_.undivided_nodes(t)});
}

/// Pairs what a region of the cutter lies between.
void CellParts::pair_cut_faces(CutFaces& cut_faces) {
    const auto sign = [this](std::int32_t half_face) { return half_faces_[index(half_face)].sign; };
    std::array<std::vector<std::int32_t>, 2> alone;
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<std::int32_t> ahead, back;  // facing as the cutter, and against it
        for (const std::int32_t half_face : cut_faces.half_faces[k])
            (sign(half_face) > 0 ? ahead : back).push_back(half_face);
        const std::size_t count = std::min(ahead.size(), back.size());
        for (std::size_t i = 0; i < count; ++i)
            cut_faces.pairs_on_one_side.push_back({ahead[i], back[i]});
        auto& rest = ahead.size() > count ? ahead : back;
        alone[k].assign(rest.begin() + static_cast<std::ptrdiff_t>(count), rest.end());
    }
    for (std::size_t i = 0; i < std::max(alone[0].size(), alone[1].size()); ++i) {
        const std::int32_t low = i < alone[0].size() ? alone[0][i] : -1;
        const std::int32_t high = i < alone[1].size() ? alone[1][i] : -1;
        if (low >= 0 && high >= 0 && sign(low) > 0 && sign(high) < 0) {
            cut_faces.pairs_through.push_back({low, high});
            continue;
        }
        for (const std::int32_t half_face : {low, high}) {
            if (half_face >= 0) cut_faces.pairs_through.push_back({half_face, -1});
        }
    }
}

/// Parts that the cutter does not separate become one.
void CellParts::join_unseparated() {
    for (CutFaces& cut_faces : cut_faces_) {
        std::erase_if(cut_faces.pairs_through, [&](const std::array<std::int32_t, 2>& pair) {
            const bool separates = cut_faces.component < 0
                                       ? sides_.separates(index(cut_faces.region))
                                       : sides_.separates_undivided(index(cut_faces.component));
            if (pair[1] < 0 || separates) return false;
            joined_->join(pair[0], pair[1]);
            has_joined_cells_ = true;
            for (const std::int32_t half_face : pair)
                loses_[index(half_faces_[index(half_face)].cell)] = 1;
            return true;
        });
    }
}

void CellParts::join_parts(Progress* progress) {
    // cells that are on one side stay whole
    const std::size_t cells = overlay_.model().cell_block.size();
    std::vector<std::uint8_t> halves(cells, 0);
    const auto bit = [](std::int8_t half) { return static_cast<std::uint8_t>(half > 0 ? 2 : 1); };
    for (const HalfFace& half_face : half_faces_)
        halves[index(half_face.cell)] |= bit(half_face.half);
    const auto is_divided = [&](std::size_t cell) {
        return halves[cell] == 3 || loses_[cell] != 0;
    };
    std::vector<std::int32_t> first(cells, -1);
    for (std::size_t s = 0; s < half_faces_.size(); ++s) {
        const auto cell = index(half_faces_[s].cell);
        if (is_divided(cell)) continue;
        if (first[cell] < 0) first[cell] = static_cast<std::int32_t>(s);
        joined_->join(first[cell], static_cast<std::int32_t>(s));
    }
    // a group of far faces is of one part of either cell
    std::vector<const FacePiece*> first_of_group(overlay_.far().groups(), nullptr);
    for (const FacePiece& face_piece : face_pieces_) {
        const std::int32_t group = overlay_.far().group(index(face_piece.face));
        if (group < 0) continue;
        const FacePiece*& leader = first_of_group[index(group)];
        if (leader == nullptr) leader = &face_piece;
        for (std::size_t k = 0; k < 2; ++k) {
            if (face_piece.half_faces[k] >= 0)
                joined_->join(leader->half_faces[k], face_piece.half_faces[k]);
        }
    }
    collect_uses(progress);
    const auto for_each_edge_of_cells = [&](std::size_t node, const auto& visit) {
        for (const auto uses : groups_of(uses_[node], &HalfFaceUse::key)) {
            if (is_divided(index(uses[0].cell))) visit(uses);
        }
    };
    std::vector<std::uint8_t> has_many(uses_.size());  // which take points that are added
    parallel_for_each(uses_.size(), {overlay_.threads(), progress}, [&](std::size_t node) {
        for_each_edge_of_cells(node, [&](std::span<const HalfFaceUse> uses) {
            if (uses.size() == 2) {
                joined_->join(uses[0].half_face, uses[1].half_face);
            } else {
                has_many[node] = 1;
            }
        });
    });
    for (std::size_t node = 0; node < uses_.size(); ++node) {
        poll(progress, node);
        if (has_many[node] == 0) continue;
        for_each_edge_of_cells(node, [&](std::span<const HalfFaceUse> uses) {
            if (uses.size() != 2) join_round_edge(uses);
        });
    }
}

/// Of several half-faces of one cell around an edge those belong together that bound one sector of
/// it: each that the cell begins at, going round, with the one where it ends.
void CellParts::join_round_edge(std::span<const HalfFaceUse> uses) {
    std::vector<arrangement::HalfPlane> scratch;
    EdgeFan fan;
    overlay_.find_fan(transformed(uses, &HalfFaceUse::use), scratch, fan);
    struct SectorBound {
        std::int32_t half_face;
        int change;  ///< 1 the cell begins, -1 it ends
    };
    std::vector<SectorBound> steps;
    for (std::size_t b = 0; b < fan.half_planes(); ++b) {
        for (const int change : {-1, 1}) {
            for (const std::size_t i : fan.half_plane(b)) {
                const std::size_t side = half_faces_[index(uses[i].half_face)].sign > 0 ? 0 : 1;
                if ((uses[i].use.ahead() == side) == (change > 0))
                    steps.push_back({uses[i].half_face, change});
            }
        }
    }
    int sum = 0, least = 0;
    std::size_t start = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        sum += steps[i].change;
        if (sum < least) {
            least = sum;
            start = i + 1;
        }
    }
    if (sum != 0)
        throw InputError("open_cell", "a cell of the model does not close around an edge", -1,
                         {uses[0].cell});
    std::vector<std::int32_t> begun;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const SectorBound& step = steps[(start + i) % steps.size()];
        if (step.change > 0) {
            begun.push_back(step.half_face);
            continue;
        }
        assert(!begun.empty());
        joined_->join(begun.back(), step.half_face);
        begun.pop_back();
    }
    assert(begun.empty());
}

/// Joins the walls of hollows that the cutter cuts out of cells with the parts around them.
void CellParts::attach_hollows(Progress* progress) {
    const auto of_cell =
        bucketize<std::int32_t>(overlay_.model().cell_count(), [this](const auto& put) {
            for (std::size_t s = 0; s < half_faces_.size(); ++s) {
                if (sides_.reaches(half_faces_[s].cell))
                    put(index(half_faces_[s].cell), static_cast<std::int32_t>(s));
            }
        });
    const auto attach = [&](std::span<const std::int32_t> of_side) {
        std::vector<Position> corners;
        const auto polygons_of = [&](std::int32_t half_face, const VisitShellPolygon& visit) {
            const auto [cell, half, sign, source] = half_faces_[index(half_face)];
            const auto visit_loop = [&](const auto& loop, int facing, const auto& at) {
                corners.clear();
                for (const NodeId node : loop)
                    corners.push_back(at(node));
                visit(corners, facing);
            };
            const auto visit_loops = [&, facing = sign](const auto& loops) {
                for (const auto& loop : loops)
                    visit_loop(loop, facing,
                               [this](NodeId node) { return overlay_.position(node); });
            };
            if (source < 0) {
                visit_cut_face_loops(cut_faces_[index(-1 - source)], visit_loops);
                return;
            }
            const FacePiece& face_piece = face_pieces_[index(source)];
            if (face_piece.divided != nullptr) {
                visit_loops(face_piece.loops());
                return;
            }
            const auto face = index(face_piece.face);
            visit_loops(std::array{overlay_.model().face(face)});
            // what is left out is with the first face of its group
            const FarFaces& far = overlay_.far();
            if (!far.is_first(face)) return;
            for (const std::int32_t other : far.of_group(far.group(face))) {
                visit_loop(far.model().face(index(other)), far.is_reversed(other) ? -sign : sign,
                           [&far](NodeId node) { return far.model().vertex(node); });
            }
        };
        join_hollows(of_side, *joined_, polygons_of);
    };
    constexpr std::size_t kCells = 1 << 8;
    parallel_ranges(of_cell.size(), kCells, {overlay_.threads(), progress},
                    [&](std::size_t begin, std::size_t end) {
                        std::vector<std::int32_t> of_side;
                        for (std::size_t cell = begin; cell < end; ++cell) {
                            for (const std::int8_t side : {kBelow, kAbove}) {
                                of_side.clear();
                                std::ranges::copy_if(of_cell[cell], std::back_inserter(of_side),
                                                     [&](std::int32_t s) {
                                                         return half_faces_[index(s)].half == side;
                                                     });
                                attach(of_side);
                            }
                        }
                    });
}

}  // namespace realmodel::cutting
