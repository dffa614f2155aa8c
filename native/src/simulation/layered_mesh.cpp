// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/column_fronts.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/element_quality.hpp"
#include "simulation/narrow_strips.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_columns.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

namespace {

constexpr int kRepairs = 30;
constexpr int kEasings = 40;
constexpr int kVainMoves = 10;         ///< rounds of moving that leave no less than the best
constexpr int kVainRepairs = 40;       ///< and with those that only give up
constexpr double kMostFailing = 0.01;  ///< heights given up, a share of elements
constexpr double kMostMended = 0.002;  ///< how much blocks may change for that, of all volumes
constexpr std::int32_t kMostFreeLayers = 16;  ///< where nothing is said about layers
constexpr double kFarthest = 8;  ///< minimum thicknesses: how far heights move at what still fails

/// What is mended: thin ends of layers, then steep faces, then what checkMesh fails with all its
/// options, at last what it fails without any.
enum class Stage { kWeak, kSteep, kFailing, kSkewed };

/// Fills the columns of all triangles from the bottom up. A front, one height at each corner, moves
/// up step by step; what lies between two fronts is an element. All three corners move by one
/// height each: a prism; two: a pyramid; one: a tetrahedron.
class ColumnFiller {
public:
    ColumnFiller(const PlanTopology& plan, const RockBlocks& blocks, const ColumnHeights& columns,
                 const PostLevels& levels, LayeredMesh& mesh, Progress* progress)
        : plan_(plan),
          blocks_(blocks),
          columns_(columns),
          levels_(levels),
          mesh_(mesh),
          is_parted_(levels.level_count(), 0) {
        find_parted();
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            poll(progress, t);
            fill(t);
            made_.offset.push_back(made_.fronts.size());
        }
    }

    /// Faces on steps that only one side has belong to the outside; those that both have are told
    /// of where a fault is.
    void finish_steps(const VerticalFaults& faults) {
        std::sort(step_faces_.begin(), step_faces_.end(), [](const SideFace& a, const SideFace& b) {
            return std::tie(a.key, a.number) < std::tie(b.key, b.number);
        });
        std::vector<const SideFace*> told;
        for (std::size_t i = 0; i < step_faces_.size();) {
            std::size_t j = i + 1;
            while (j < step_faces_.size() && step_faces_[j].key == step_faces_[i].key)
                ++j;
            SideFace& face = step_faces_[i];
            if (!faults.empty())
                face.surface = faults.fault_at(face.edge[0], face.edge[1], face.height);
            if (j == i + 1 || face.surface != kWall) told.push_back(&face);
            i = j;
        }
        std::sort(told.begin(), told.end(),
                  [](const SideFace* a, const SideFace* b) { return a->number < b->number; });
        for (const SideFace* face : told)
            add_side(face->corners, face->surface);
    }

    const ColumnFronts& columns() const { return made_; }

private:
    void fill(std::size_t t) {
        if (!load(t)) return;
        const auto layer_blocks = levels_.layer_blocks(rock_);
        for (std::size_t i = 0; i < 3; ++i)
            front_[i] = own_[i][0];
        last_block_ = -1;
        made_.fronts.push_back(front_);
        for (std::size_t l = 0; l < layer_blocks.size(); ++l) {
            block_ = layer_blocks[l];
            layer_ = static_cast<std::int32_t>(l);
            const Front top{own_[0][l + 1], own_[1][l + 1], own_[2][l + 1]};
            if (top == front_) continue;
            Front parted = front_;
            for (std::size_t i = 0; i < 3; ++i) {
                if (is_parted_[levels_.level_offset(post_[i]) + l] != 0) parted[i] = top[i];
            }
            if (has_step_ && parted != front_) pass_lines(parted);
            move(parted);
            move(top);
        }
        made_.blocks.push_back(-1);
        if (last_block_ >= 0) add_flat_face(-1);
    }

    struct SideFace {
        std::array<std::int32_t, 4> key, corners;  // of a triangle the last corner is -1
        std::size_t number;
        std::array<PlanPoint, 2> edge;
        double height;  ///< of its center
        std::int32_t surface;
    };

    std::int32_t point(std::size_t corner, std::int32_t at) const {
        return static_cast<std::int32_t>(levels_.node_offset(index(node_[corner]))) + at;
    }
    Front points(const Front& front) const {
        return {point(0, front[0]), point(1, front[1]), point(2, front[2])};
    }

    /// The posts of a triangle; false where nothing stands on it.
    bool load(std::size_t t) {
        t_ = t;
        rock_ = plan_.rock(t);
        for (std::size_t i = 0; i < 3; ++i) {
            post_[i] = index(plan_.posts()[3 * t + i]);
            node_[i] = plan_.mesh().triangles[t][i];
            own_[i] = levels_.levels(post_[i]);
            if (columns_.rock(post_[i]) != rock_ || rock_ < 0) return false;
        }
        find_step();
        return true;
    }

    /// A layer of a post beside a step is parted where the other side has heights within it. There
    /// the corner moves before the others, in all triangles at the post; so do both ends of an edge
    /// on a step, if one of them does. (No other edge has two such ends: PlanTopology.)
    void find_parted() {
        std::vector<std::array<std::size_t, 2>> pairs;  // levels of both ends
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            const auto& nodes = plan_.mesh().triangles[t];
            if (std::none_of(nodes.begin(), nodes.end(),
                             [&](std::int32_t n) { return plan_.is_divided(n); }) ||
                !load(t))
                continue;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t l = 0; l + 1 < own_[i].size(); ++l) {
                    if (own_[i][l + 1] > own_[i][l] + 1)
                        is_parted_[levels_.level_offset(post_[i]) + l] = 1;
                }
            }
            if (!has_step_) continue;
            const auto [u, v] = step_;
            for (std::size_t l = 0; l + 1 < own_[u].size(); ++l) {
                const std::size_t at_u = levels_.level_offset(post_[u]) + l,
                                  at_v = levels_.level_offset(post_[v]) + l;
                pairs.push_back({at_u, at_v});
                const std::array<std::int32_t, 2> low{own_[u][l], own_[v][l]},
                    high{own_[u][l + 1], own_[v][l + 1]};
                const bool parted =
                    std::any_of(lines_.begin(), lines_.end(), [&](const auto& line) {
                        return line[0] >= low[0] && line[1] >= low[1] && line[0] <= high[0] &&
                               line[1] <= high[1] && line != low && line != high;
                    });
                if (parted) is_parted_[at_u] = is_parted_[at_v] = 1;
            }
        }
        for (bool any = true; any;) {
            any = false;
            for (const auto& [u, v] : pairs) {
                if (is_parted_[u] == is_parted_[v]) continue;
                is_parted_[u] = is_parted_[v] = 1;
                any = true;
            }
        }
    }

    /// The edge on a step, and the levels of the other side along it.
    void find_step() {
        has_step_ = false;
        for (std::size_t i = 0; i < 3; ++i) {
            if (!plan_.is_step(t_, i) || plan_.neighbor(t_, i) < 0) continue;
            has_step_ = true;
            step_ = {i, (i + 1) % 3};
            const auto other = index(plan_.neighbor(t_, i));
            std::array<std::span<const std::int32_t>, 2> beyond;
            for (std::size_t k = 0; k < 2; ++k) {
                for (std::size_t j = 0; j < 3; ++j) {
                    if (plan_.mesh().triangles[other][j] == node_[step_[k]])
                        beyond[k] = levels_.levels(index(plan_.posts()[3 * other + j]));
                }
            }
            lines_.clear();
            for (std::size_t l = 0; l < beyond[0].size(); ++l)
                lines_.push_back({beyond[0][l], beyond[1][l]});
            std::sort(lines_.begin(), lines_.end());
            lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
        }
    }

    /// Moves along the levels of the other side of the step that lie between the front and its next
    /// place.
    void pass_lines(const Front& top) {
        const auto [u, v] = step_;
        for (const auto& [to_u, to_v] : lines_) {
            if (to_u < front_[u] || to_v < front_[v] || to_u > top[u] || to_v > top[v]) continue;
            if ((to_u == front_[u] && to_v == front_[v]) || (to_u == top[u] && to_v == top[v]))
                continue;
            Front next = front_;
            next[u] = to_u;
            next[v] = to_v;
            move(next);
        }
    }

    /// Moves the front; corners that have heights in between go alone first, in the order of their
    /// nodes, so that both triangles at an edge do the same.
    void move(const Front& to) {
        std::array<std::size_t, 3> corners{0, 1, 2};
        std::sort(corners.begin(), corners.end(),
                  [&](std::size_t a, std::size_t b) { return node_[a] < node_[b]; });
        for (const std::size_t c : corners) {
            while (front_[c] + 1 < to[c]) {
                Front next = front_;
                ++next[c];
                advance(next);
            }
        }
        advance(to);
    }

    void advance(const Front& to) {
        if (to == front_) return;
        if (last_block_ != block_) add_flat_face(block_);
        last_block_ = block_;
        const Front low = points(front_), high = points(to);
        std::size_t moved = 0;
        for (std::size_t i = 0; i < 3; ++i)
            moved += to[i] != front_[i];
        if (moved == 3) {
            add(mesh_.prisms, {low[0], low[1], low[2], high[0], high[1], high[2]});
        } else if (moved == 2) {
            std::size_t c = 0;
            while (to[c] != front_[c])
                ++c;
            const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
            add(mesh_.pyramids, {low[b], low[a], high[a], high[b], low[c]});
        } else {
            std::size_t a = 0;
            while (to[a] == front_[a])
                ++a;
            add(mesh_.tetrahedra, {low[0], low[1], low[2], high[a]});
        }
        const PlanPoint &o = plan_.mesh().vertices[index(node_[0])],
                        &p = plan_.mesh().vertices[index(node_[1])],
                        &q = plan_.mesh().vertices[index(node_[2])];
        const double area = ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])) / 2;
        double rise = 0;
        for (std::size_t i = 0; i < 3; ++i)
            rise += levels_.heights(node_[i])[index(to[i])] -
                    levels_.heights(node_[i])[index(front_[i])];
        mesh_.volumes[index(block_)] += area * rise / 3;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const bool outside = plan_.neighbor(t_, i) < 0;
            if (!outside && !plan_.is_step(t_, i)) continue;
            if (low[i] == high[i] && low[j] == high[j]) continue;
            std::array<std::int32_t, 4> corners{low[i], low[j], high[j], high[i]};
            if (low[j] == high[j]) corners = {low[i], low[j], high[i], -1};
            if (low[i] == high[i]) corners = {low[i], low[j], high[j], -1};
            if (outside) {
                add_side(corners, kWall);
            } else {
                std::array<std::int32_t, 4> key = corners;
                std::sort(key.begin(), key.end());
                const auto &a = plan_.mesh().vertices[index(node_[i])],
                           &b = plan_.mesh().vertices[index(node_[j])];
                const double height = (position(i, front_[i])[2] + position(i, to[i])[2] +
                                       position(j, front_[j])[2] + position(j, to[j])[2]) /
                                      4;
                step_faces_.push_back({key, corners, step_faces_.size(), {a, b}, height, kWall});
            }
        }
        front_ = to;
        made_.fronts.push_back(to);
        made_.blocks.push_back(block_);
    }

    std::array<double, 3> position(std::size_t corner, std::int32_t at) const {
        const PlanPoint& p = plan_.mesh().vertices[index(node_[corner])];
        return {p[0], p[1], levels_.heights(node_[corner])[index(at)]};
    }

    template <std::size_t N>
    void add(LayeredMesh::Elements<N>& elements, const std::array<std::int32_t, N>& corners) {
        elements.corners.push_back(corners);
        elements.block.push_back(block_);
        elements.column.push_back(static_cast<std::int32_t>(t_));
        elements.layer.push_back(mesh_.layers - 1 - layer_);
    }

    void add_side(const std::array<std::int32_t, 4>& corners, std::int32_t surface) {
        if (corners[3] < 0) {
            mesh_.triangles.corners.push_back({corners[0], corners[1], corners[2]});
            mesh_.triangles.surface.push_back(surface);
        } else {
            mesh_.quadrilaterals.corners.push_back(corners);
            mesh_.quadrilaterals.surface.push_back(surface);
        }
    }

    /// The face at the front between the last block and the next; -1: outside.
    void add_flat_face(std::int32_t next) {
        Front corners = points(front_);
        if (last_block_ < 0) std::swap(corners[1], corners[2]);
        mesh_.triangles.corners.push_back(corners);
        mesh_.triangles.surface.push_back(surface_between(last_block_, next));
    }

    /// The surface at the top of one block, as most corners have it where there is that block.
    std::int32_t surface_between(std::int32_t below, std::int32_t above) const {
        const auto first = blocks_.first[index(rock_)];
        const auto level = below < 0   ? std::size_t{0}
                           : above < 0 ? index(blocks_.blocks_of(rock_))
                                       : static_cast<std::size_t>(below - first) + 1;
        std::int32_t best = -1, most = 0;
        for (const bool present_only : {true, false}) {
            const auto counts = [&](std::size_t i) {
                const auto z = columns_.levels(post_[i]);
                return !present_only || level == 0 || z[level] > z[level - 1];
            };
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t own = columns_.surfaces(post_[i])[level];
                std::int32_t votes = 0;
                for (std::size_t j = 0; j < 3; ++j)
                    votes += counts(j) && columns_.surfaces(post_[j])[level] == own ? 1 : 0;
                if (std::tie(votes, own) > std::tie(most, best)) {
                    most = votes;
                    best = own;
                }
            }
            if (most > 0) break;
        }
        return best;
    }

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& columns_;
    const PostLevels& levels_;
    LayeredMesh& mesh_;

    std::size_t t_ = 0;
    std::int32_t rock_ = -1, block_ = -1, last_block_ = -1, layer_ = 0;
    std::array<std::size_t, 3> post_{};
    std::array<std::int32_t, 3> node_{};
    std::array<std::span<const std::int32_t>, 3> own_;
    Front front_{};
    ColumnFronts made_;
    bool has_step_ = false;
    std::array<std::size_t, 2> step_{};
    std::vector<std::array<std::int32_t, 2>> lines_;
    std::vector<SideFace> step_faces_;
    std::vector<std::uint8_t> is_parted_;  ///< of each layer of each post
};

/// Faces that are steep, so that the centers of neighbors lie far from the direction across them,
/// are made less steep: at first all heights of a node move, then each for itself.
/// @param reach  minimum thicknesses: how far heights move at most  @return whether any did
bool ease_steep(const PlanTopology& plan, const ColumnHeights& columns,
                const ElementQuality& quality, double minimum_thickness, double reach,
                PostLevels& levels) {
    std::vector<std::uint8_t> is_moved, has_flat_base(plan.nodes(), 0);
    for (std::size_t p = 0; p < plan.post_count(); ++p) {
        if (columns.rock(p) >= 0 && columns.surfaces(p)[0] == kBase)
            has_flat_base[index(plan.post_node(p))] = 1;
    }
    bool any = false;
    for (const bool alone : {false, true}) {
        is_moved.assign(plan.nodes(), 1);
        for (int round = 0; round < kEasings; ++round) {
            const auto moves = quality.steep(is_moved);
            is_moved.assign(plan.nodes(), 0);
            if (!levels.ease(moves, reach * minimum_thickness, minimum_thickness, alone,
                             has_flat_base, is_moved))
                break;
            any = true;
        }
    }
    return any;
}

/// Calls visit(corner) for the corners of all elements and faces.
template <class Visit>
void for_corners(LayeredMesh& mesh, const Visit& visit) {
    const auto all = [&](auto& rows) {
        for (auto& row : rows) {
            for (std::int32_t& corner : row)
                visit(corner);
        }
    };
    all(mesh.tetrahedra.corners);
    all(mesh.pyramids.corners);
    all(mesh.prisms.corners);
    all(mesh.triangles.corners);
    all(mesh.quadrilaterals.corners);
}

/// Columns between levels, mended until nothing is left to mend.
class Columns {
public:
    Columns(const ComplexView& model, const PlanLines& lines, const RockBlocks& blocks,
            const PlanTopology& plan, const ColumnHeights& heights, Progress* progress)
        : model_(model),
          lines_(lines),
          blocks_(blocks),
          plan_(plan),
          heights_(heights),
          progress_(progress) {}

    LayeredMesh fill(const Layering& layering) {
        PostLevels levels(plan_, lines_, blocks_, heights_, layering);
        Repair repair;
        is_narrow_.clear();
        for (;;) {
            check_total(levels.height_count(), INT32_MAX);
            LayeredMesh made;
            made.volumes.assign(blocks_.rock.size(), 0);
            for (std::size_t r = 0; r < blocks_.count(); ++r) {
                const auto own = levels.layer_blocks(static_cast<std::int32_t>(r)).size();
                made.layers = std::max(made.layers, static_cast<std::int32_t>(own));
            }
            ColumnFiller filler(plan_, blocks_, heights_, levels, made, progress_);
            const ElementQuality quality(plan_, levels, filler.columns(),
                                         layering.minimum_thickness, progress_);
            if (is_narrow_.empty()) is_narrow_ = narrow_strips(plan_, filler.columns());
            if (mend(quality, layering, made, levels, repair)) continue;
            filler.finish_steps(VerticalFaults(model_, lines_.steps));
            number_points(levels, made);
            return made;
        }
    }

private:
    struct Repair {
        Stage stage = Stage::kWeak;
        std::optional<PostLevels> best;
        std::vector<double> volumes;  // before the last stage but one
        std::size_t least = SIZE_MAX;
        double reach = 1;
        int round = 0, vain = 0;
    };

    /// Whether levels changed, so that columns have to be filled again.
    bool mend(const ElementQuality& quality, const Layering& layering, LayeredMesh& made,
              PostLevels& levels, Repair& repair) const {
        if (repair.stage == Stage::kWeak) {
            auto weak = quality.weak(is_narrow_);
            if (repair.round++ < kRepairs && levels.remove(plan_, weak) > 0) return true;
            repair.stage = Stage::kSteep;
        }
        if (repair.stage == Stage::kSteep) {
            repair.stage = Stage::kFailing;
            if (ease_steep(plan_, heights_, quality, layering.minimum_thickness, repair.reach,
                           levels))
                return true;
        }
        if (repair.stage == Stage::kFailing && mend_failing(quality, made, levels, repair))
            return true;
        repair.stage = Stage::kSkewed;
        auto skewed = quality.skewed(layering.divided);
        if (levels.remove(plan_, skewed.removals, true) > 0) return true;
        made.skewed = {skewed.faces, skewed.most, skewed.place, std::move(skewed.tall)};
        return false;
    }

    bool mend_failing(const ElementQuality& quality, const LayeredMesh& made, PostLevels& levels,
                      Repair& repair) const {
        auto& [stage, best, volumes, least, reach, round, vain] = repair;
        auto failing = quality.failing(is_narrow_);
        if (!best && failing.size() > kMostFailing * quality.elements()) failing.clear();
        if (!best) volumes = made.volumes;
        double changed = 0, total = 0;
        for (std::size_t b = 0; b < volumes.size(); ++b) {
            changed += std::abs(made.volumes[b] - volumes[b]);
            total += volumes[b];
        }
        if (changed > kMostMended * total) vain = kVainRepairs;
        if (!failing.empty() && vain < kVainRepairs) {
            if (failing.size() < least) {
                least = failing.size();
                best = levels;
                vain = 0;
            } else {
                ++vain;
            }
            // what moving farther does not mend is given up; at last nothing moves any more
            if (vain == kVainMoves)
                levels = *best;
            else if (reach > 1)
                levels.remove(plan_, failing);
            reach = kFarthest;
            if (vain < kVainMoves) stage = Stage::kSteep;
            return true;
        }
        if (!best || (failing.empty() && changed <= kMostMended * total)) return false;
        levels = *best;
        stage = Stage::kSkewed;
        return true;
    }

    /// Points of the mesh for those heights of nodes that elements have.
    void number_points(const PostLevels& levels, LayeredMesh& made) const {
        std::vector<std::int32_t> number(levels.height_count(), -1);
        for_corners(made, [&](std::int32_t& corner) { number[index(corner)] = 0; });
        for (std::size_t n = 0, at = 0; n < plan_.nodes(); ++n) {
            const PlanPoint& p = plan_.mesh().vertices[n];
            for (const double z : levels.heights(static_cast<std::int32_t>(n))) {
                if (number[at] == 0) {
                    number[at] = static_cast<std::int32_t>(made.points.size());
                    made.points.push_back({p[0], p[1], z});
                }
                ++at;
            }
        }
        for_corners(made, [&](std::int32_t& corner) { corner = number[index(corner)]; });
    }

    const ComplexView& model_;
    const PlanLines& lines_;
    const RockBlocks& blocks_;
    const PlanTopology& plan_;
    const ColumnHeights& heights_;
    Progress* progress_;
    std::vector<std::uint8_t> is_narrow_;
};

}  // namespace

LayeredMesh layered_mesh(const ComplexView& model, std::span<const std::int32_t> block_rock,
                         const PlanLines& lines, meshing::PlanarMesh mesh, Layering layering,
                         const Execution& execution) {
    const RockBlocks blocks(block_rock);
    PlanTopology plan(lines, std::move(mesh));
    const ColumnHeights heights = post_columns(model, blocks, lines, plan, execution);
    std::vector<std::uint8_t> is_free(layering.layers.size(), 0);
    for (std::size_t b = 0; b < is_free.size(); ++b) {
        if (layering.layers[b] != 0 || layering.layer_thickness > 0) continue;
        layering.layers[b] = 1;
        is_free[b] = 1;
    }
    Columns columns(model, lines, blocks, plan, heights, execution.progress);
    LayeredMesh made;
    for (bool again = true; again;) {
        made = columns.fill(layering);
        again = false;
        for (const std::int32_t block : made.skewed.tall) {
            if (is_free[index(block)] == 0 || layering.layers[index(block)] >= kMostFreeLayers)
                continue;
            layering.layers[index(block)] *= 2;
            again = true;
        }
    }
    made.block_layers = std::move(layering.layers);
    made.plan = plan.take_mesh();
    return made;
}

}  // namespace realmodel::simulation
