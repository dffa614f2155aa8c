// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/columns.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"
#include "simulation/column_heights.hpp"

namespace realmodel::simulation {

namespace {

/// Lines are moved by about an edge length where they are simplified.
constexpr double kReach = 1.5;
/// Of its area, in plan: a face with less is vertical but for the rounding of its vertices.
constexpr double kUpright = 1e-6;
constexpr double kSame = 1e-9;  ///< of an edge: distances that differ by less are the same

struct NearestOnLine {
    double distance, share;  ///< of the way along a line
};

NearestOnLine nearest_on(const std::array<PlanPoint, 2>& line, const PlanPoint& p) {
    const double share = nearest_share(line[0], line[1], p);
    return {distance(p, moved(line[0], share, minus(line[1], line[0]))), share};
}

bool is_upright(const ComplexView& model, std::size_t face) {
    const auto loop = model.face(face);
    const Vec3 area =
        polygon_normal(loop.size(), [&](std::size_t i) { return model.vertex(loop[i]); });
    return std::abs(area[2]) < kUpright * elementary::hypot(area[0], area[1]);
}

PlanPoint farthest_from(const ComplexView& model, std::span<const std::int32_t> loop,
                        const PlanPoint& from) {
    PlanPoint farthest = from;
    double most = 0;
    for (const std::int32_t v : loop) {
        const PlanPoint p = plan_of(model, v);
        const double far = distance(from, p);
        if (far <= most) continue;
        most = far;
        farthest = p;
    }
    return farthest;
}

}  // namespace

VerticalFaults::VerticalFaults(const ComplexView& model,
                               std::span<const std::array<PlanPoint, 2>> steps)
    : model_(model),
      steps_(steps),
      faces_([&] {
          std::vector<VerticalFace> faces;
          for (std::size_t f = 0; f < model.face_count(); ++f) {
              if (model.face_surface[f] < 0 || !is_upright(model, f)) continue;
              const auto loop = model.face(f);
              const PlanPoint end = farthest_from(model, loop, plan_of(model, loop[0]));
              const std::array<PlanPoint, 2> line{end, farthest_from(model, loop, end)};
              faces.push_back({static_cast<std::int32_t>(f), line});
          }
          return faces;
      }()),
      face_tree_(
          transformed(faces_, [](const VerticalFace& f) { return spatial::bounding_box(f.line); })),
      step_tree_(tree_in_plan(faces_.empty() ? std::span(steps_).first(0) : steps_)) {}

std::int32_t VerticalFaults::fault_at(const PlanPoint& from, const PlanPoint& to,
                                      double height) const {
    const PlanPoint middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2};
    const double edge = distance(from, to);
    spatial::Box box;
    box.include(middle);
    box.widen(kReach * edge);
    double least = kReach * edge;
    face_tree_.find(box, [&](std::int32_t n) {
        least = std::min(least, nearest_on(faces_[index(n)].line, middle).distance);
    });
    bool is_other = false;
    step_tree_.find(box, [&](std::int32_t n) {
        is_other = is_other || nearest_on(steps_[index(n)], middle).distance < least - kSame * edge;
    });
    if (is_other) return kWall;
    std::int32_t fault = kWall;
    face_tree_.find(box, [&](std::int32_t n) {
        const VerticalFace& face = faces_[index(n)];
        const NearestOnLine near = nearest_on(face.line, middle);
        if (near.distance <= least + kSame * edge &&
            reaches(face, near.share, height, kSame * edge))
            fault = std::max(fault, model_.face_surface[index(face.number)]);
    });
    return fault;
}

/// Whether a face has this height, at a share of its way in plan.
bool VerticalFaults::reaches(const VerticalFace& face, double share, double height,
                             double rounding) const {
    const auto loop = model_.face(index(face.number));
    const PlanPoint way = minus(face.line[1], face.line[0]);
    const auto share_of = [&](const Vec3& p) {
        return dot(minus({p[0], p[1]}, face.line[0]), way) / dot(way, way);
    };
    double low = HUGE_VAL, high = -HUGE_VAL;
    const auto include = [&](double z) {
        low = std::min(low, z);
        high = std::max(high, z);
    };
    auto p = model_.vertex(loop.back());
    double s = share_of(p);
    for (const std::int32_t v : loop) {
        const auto q = model_.vertex(v);
        const double t = share_of(q);
        if (std::abs(t - share) <= kSame) include(q[2]);
        if (std::min(s, t) < share && share < std::max(s, t))
            include(p[2] + (share - s) / (t - s) * (q[2] - p[2]));
        p = q;
        s = t;
    }
    return low - rounding <= height && height <= high + rounding;
}

namespace {

/// @param corners  of a triangle the last is -1
void add_face(LayeredMesh& mesh, const std::array<std::int32_t, 4>& corners, std::int32_t surface) {
    if (corners[3] < 0) {
        mesh.triangles.corners.push_back({corners[0], corners[1], corners[2]});
        mesh.triangles.surface.push_back(surface);
    } else {
        mesh.quadrilaterals.corners.push_back(corners);
        mesh.quadrilaterals.surface.push_back(surface);
    }
}

class ColumnFiller {
public:
    ColumnFiller(const ColumnInput& input, const PillarLevels& levels)
        : plan_(input.plan),
          blocks_(input.blocks),
          columns_(input.heights),
          levels_(levels),
          is_parted_(levels.level_count(), 0) {
        check_total(levels.height_count(), INT32_MAX);
        made_.mesh.volumes.assign(blocks_.rock.size(), 0);
        for (std::size_t r = 0; r < blocks_.count(); ++r) {
            const auto layers = levels.layer_blocks(static_cast<std::int32_t>(r)).size();
            made_.mesh.layers = std::max(made_.mesh.layers, static_cast<std::int32_t>(layers));
        }
    }

    FilledColumns run(Progress* progress) {
        find_parted();
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            poll(progress, t);
            fill(t);
            made_.fronts.offset.push_back(made_.fronts.fronts.size());
        }
        return std::move(made_);
    }

private:
    /// The pillars of a triangle; false where nothing stands on it.
    bool load(std::size_t t) {
        t_ = t;
        rock_ = plan_.rock(t);
        node_ = plan_.corners(t);
        for (std::size_t i = 0; i < 3; ++i) {
            pillar_[i] = plan_.pillar(t, i);
            level_[i] = levels_.levels(pillar_[i]);
            if (columns_.rock(pillar_[i]) != rock_ || rock_ < 0) return false;
            first_[i] = static_cast<std::int32_t>(levels_.node_offset(index(node_[i])));
        }
        area_ = twice_area(plan_.point(node_[0]), plan_.point(node_[1]), plan_.point(node_[2])) / 2;
        order_ = {0, 1, 2};
        std::ranges::sort(order_, {}, [&](std::size_t corner) { return node_[corner]; });
        find_step();
        return true;
    }

    /// The edge on a step, and the levels of the other side along it.
    void find_step() {
        has_step_ = has_open_edge_ = false;
        for (std::size_t i = 0; i < 3; ++i) {
            if (plan_.neighbor(t_, i) < 0) has_open_edge_ = true;
            if (!plan_.is_inner_step(t_, i)) continue;
            assert(!has_step_);
            has_step_ = true;
            step_ = {i, (i + 1) % 3};
            const auto pillars = plan_.pillars_beyond(t_, i);
            const auto u = levels_.levels(pillars[0]), v = levels_.levels(pillars[1]);
            lines_.clear();
            for (std::size_t l = 0; l < std::min(u.size(), v.size()); ++l)
                lines_.push_back({u[l], v[l]});
            sort_unique(lines_);
        }
    }

    /// A layer of a pillar beside a step is parted where the other side has heights within it.
    /// There the corner moves before the others, in all triangles at the pillar; so do both ends of
    /// an edge on a step, if one of them does. (No other edge has two such ends: adapt_plan.)
    void find_parted() {
        std::vector<std::array<std::size_t, 2>> pairs;  // levels of both ends
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            const auto& nodes = plan_.corners(t);
            if (std::none_of(nodes.begin(), nodes.end(),
                             [&](std::int32_t n) { return plan_.is_divided(n); }) ||
                !load(t))
                continue;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t l = 0; l + 1 < level_[i].size(); ++l) {
                    if (level_[i][l + 1] > level_[i][l] + 1)
                        is_parted_[levels_.level_offset(pillar_[i]) + l] = 1;
                }
            }
            if (!has_step_) continue;
            const auto [u, v] = step_;
            for (std::size_t l = 0; l + 1 < level_[u].size(); ++l) {
                const std::size_t at_u = levels_.level_offset(pillar_[u]) + l,
                                  at_v = levels_.level_offset(pillar_[v]) + l;
                pairs.push_back({at_u, at_v});
                const std::array<std::int32_t, 2> low{level_[u][l], level_[v][l]},
                    high{level_[u][l + 1], level_[v][l + 1]};
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

    void fill(std::size_t t) {
        if (!load(t)) return;
        const auto layer_blocks = levels_.layer_blocks(rock_);
        for (std::size_t i = 0; i < 3; ++i)
            front_[i] = level_[i][0];
        last_block_ = -1;
        made_.fronts.fronts.push_back(front_);
        for (std::size_t l = 0; l < layer_blocks.size(); ++l) {
            block_ = layer_blocks[l];
            layer_ = static_cast<std::int32_t>(l);
            const LevelFront top{level_[0][l + 1], level_[1][l + 1], level_[2][l + 1]};
            if (top == front_) continue;
            LevelFront parted = front_;
            for (std::size_t i = 0; i < 3; ++i) {
                if (is_parted(i, l)) parted[i] = top[i];
            }
            if (has_step_ && parted != front_) pass_lines(parted);
            move(parted);
            move(top);
            assert(front_ == top);
        }
        made_.fronts.blocks.push_back(-1);
        if (last_block_ >= 0) add_flat_face(-1);
    }

    /// Moves along the levels of the other side of the step that lie between the front and its next
    /// position.
    void pass_lines(const LevelFront& top) {
        const auto [u, v] = step_;
        for (const auto& [to_u, to_v] : lines_) {
            if (to_u < front_[u] || to_v < front_[v] || to_u > top[u] || to_v > top[v]) continue;
            if ((to_u == front_[u] && to_v == front_[v]) || (to_u == top[u] && to_v == top[v]))
                continue;
            LevelFront next = front_;
            next[u] = to_u;
            next[v] = to_v;
            move(next);
        }
    }

    /// Moves the front; corners that have heights in between go alone first, in the order of their
    /// nodes, so that both triangles at an edge do the same.
    void move(const LevelFront& to) {
        for (const std::size_t c : order_) {
            while (front_[c] + 1 < to[c]) {
                LevelFront next = front_;
                ++next[c];
                advance(next);
            }
        }
        advance(to);
    }

    /// Makes the element between the front and the next one.
    void advance(const LevelFront& to) {
        if (to == front_) return;
        for (std::size_t i = 0; i < 3; ++i)
            assert(to[i] == front_[i] || to[i] == front_[i] + 1);
        if (last_block_ != block_) add_flat_face(block_);
        last_block_ = block_;
        add_element(to);
        if (has_step_ || has_open_edge_) add_lateral_faces(to);
        front_ = to;
        made_.fronts.fronts.push_back(to);
        made_.fronts.blocks.push_back(block_);
    }

    void add_element(const LevelFront& to) {
        const LevelFront low = points(front_), high = points(to);
        std::size_t moved = 0, still = 0, last_moved = 0;
        double rise = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const bool moves = to[i] != front_[i];
            moved += moves;
            (moves ? last_moved : still) = i;
            rise += height(i, to[i]) - height(i, front_[i]);
        }
        if (moved == 3) {
            add(made_.mesh.prisms, {low[0], low[1], low[2], high[0], high[1], high[2]});
        } else if (moved == 2) {
            const std::size_t a = (still + 1) % 3, b = (still + 2) % 3;
            add(made_.mesh.pyramids, {low[b], low[a], high[a], high[b], low[still]});
        } else {
            add(made_.mesh.tetrahedra, {low[0], low[1], low[2], high[last_moved]});
        }
        made_.mesh.volumes[index(block_)] += area_ * rise / 3;
    }

    /// The upright faces at the border and on steps.
    void add_lateral_faces(const LevelFront& to) {
        const LevelFront low = points(front_), high = points(to);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const bool outside = plan_.neighbor(t_, i) < 0;
            if (!outside && !plan_.is_inner_step(t_, i)) continue;
            if (low[i] == high[i] && low[j] == high[j]) continue;
            std::array<std::int32_t, 4> corners{low[i], low[j], high[j], high[i]};
            if (low[j] == high[j]) corners = {low[i], low[j], high[i], -1};
            if (low[i] == high[i]) corners = {low[i], low[j], high[j], -1};
            if (outside) {
                add_face(made_.mesh, corners, kWall);
                continue;
            }
            std::array<std::int32_t, 4> key = corners;
            std::sort(key.begin(), key.end());
            const double center = (height(i, front_[i]) + height(i, to[i]) + height(j, front_[j]) +
                                   height(j, to[j])) /
                                  4;
            made_.step_faces.push_back({key,
                                        corners,
                                        made_.step_faces.size(),
                                        {plan_.point(node_[i]), plan_.point(node_[j])},
                                        center,
                                        kWall});
        }
    }

    LevelFront points(const LevelFront& front) const {
        LevelFront corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = first_[i] + front[i];
        return corners;
    }

    template <std::size_t N>
    void add(LayeredMesh::Elements<N>& elements, const std::array<std::int32_t, N>& corners) {
        elements.corners.push_back(corners);
        elements.block.push_back(block_);
        elements.column.push_back(static_cast<std::int32_t>(t_));
        elements.layer.push_back(made_.mesh.layers - 1 - layer_);
    }

    /// The face at the front between the last block and the next; -1: outside.
    void add_flat_face(std::int32_t next) {
        LevelFront corners = points(front_);
        if (last_block_ < 0) std::swap(corners[1], corners[2]);
        add_face(made_.mesh, {corners[0], corners[1], corners[2], -1},
                 surface_between(last_block_, next));
    }

    /// The surface at the top of one block, as most corners have it where there is that block.
    std::int32_t surface_between(std::int32_t below, std::int32_t above) const {
        const auto first = blocks_.first[index(rock_)];
        const auto level = below < 0   ? std::size_t{0}
                           : above < 0 ? index(blocks_.blocks_of(rock_))
                                       : static_cast<std::size_t>(below - first) + 1;
        const auto surface = [&](std::size_t i) { return columns_.surfaces(pillar_[i])[level]; };
        if (surface(0) == surface(1) && surface(1) == surface(2)) return surface(0);
        std::int32_t best = -1, most = 0;
        for (const bool present_only : {true, false}) {
            const auto counts = [&](std::size_t i) {
                const auto z = columns_.levels(pillar_[i]);
                return !present_only || level == 0 || z[level] > z[level - 1];
            };
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t candidate = surface(i);
                std::int32_t votes = 0;
                for (std::size_t j = 0; j < 3; ++j)
                    votes += counts(j) && surface(j) == candidate ? 1 : 0;
                if (std::tie(votes, candidate) > std::tie(most, best)) {
                    most = votes;
                    best = candidate;
                }
            }
            if (most > 0) break;
        }
        return best;
    }

    bool is_parted(std::size_t corner, std::size_t layer) const {
        return is_parted_[levels_.level_offset(pillar_[corner]) + layer] != 0;
    }
    double height(std::size_t corner, std::int32_t at) const {
        return levels_.heights(node_[corner])[index(at)];
    }

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& columns_;
    const PillarLevels& levels_;
    FilledColumns made_;
    std::vector<std::uint8_t> is_parted_;  ///< of each layer of each pillar: find_parted()

    // of the triangle whose column is filled
    std::size_t t_ = 0;
    std::int32_t rock_ = -1, block_ = -1, last_block_ = -1, layer_ = 0;
    std::array<std::size_t, 3> pillar_{};
    std::array<std::int32_t, 3> node_{}, first_{};  ///< first_: number of the first height of each
    std::array<std::size_t, 3> order_{};            ///< its corners by their nodes
    double area_ = 0;
    std::array<std::span<const std::int32_t>, 3> level_;  ///< the levels of its pillars
    LevelFront front_{};
    bool has_step_ = false, has_open_edge_ = false;   ///< on an inner step, at the border
    std::array<std::size_t, 2> step_{};               ///< the corners of its edge on a step
    std::vector<std::array<std::int32_t, 2>> lines_;  ///< the levels of the other side there
};

}  // namespace

FilledColumns fill_columns(const ColumnInput& input, const PillarLevels& levels,
                           Progress* progress) {
    return ColumnFiller(input, levels).run(progress);
}

void add_step_faces(FilledColumns& columns, const VerticalFaults& faults) {
    using StepFace = FilledColumns::StepFace;
    std::vector<StepFace>& faces = columns.step_faces;
    std::ranges::sort(faces, {},
                      [](const StepFace& face) { return std::pair(face.key, face.number); });
    std::vector<const StepFace*> remaining_faces;
    for (const auto equal : groups_of(faces, &StepFace::key)) {
        assert(equal.size() <= 2);
        StepFace& face = equal[0];
        if (!faults.empty())
            face.surface = faults.fault_at(face.edge[0], face.edge[1], face.height);
        if (equal.size() == 1 || face.surface != kWall) remaining_faces.push_back(&face);
    }
    std::ranges::sort(remaining_faces, {}, &StepFace::number);
    for (const StepFace* face : remaining_faces)
        add_face(columns.mesh, face->corners, face->surface);
}

namespace {

constexpr std::int32_t kMostSteps = 4;  ///< across edges, from columns of more elements

}  // namespace

std::vector<std::uint8_t> narrow_strips(const PlanTopology& plan, const ColumnFronts& columns) {
    const std::size_t count = plan.triangles();
    DisjointSets strips(count);
    std::vector<std::int32_t> steps(count, -1);  // to columns of more elements
    std::vector<std::int32_t> open;
    const auto visit_beside = [&](std::size_t t, const auto& visit) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = plan.neighbor(t, i);
            if (n >= 0 && columns.elements(index(n)) == 1 && plan.rock(index(n)) == plan.rock(t))
                visit(n);
        }
    };
    for (std::size_t t = 0; t < count; ++t) {
        const auto number = static_cast<std::int32_t>(t);
        if (columns.elements(t) == 1)
            visit_beside(t, [&](std::int32_t n) { strips.join(number, n); });
        if (columns.elements(t) < 2) continue;
        steps[t] = 0;
        open.push_back(number);
    }
    for (std::size_t k = 0; k < open.size(); ++k) {
        const std::int32_t next = steps[index(open[k])] + 1;
        visit_beside(index(open[k]), [&](std::int32_t n) {
            if (steps[index(n)] >= 0) return;
            steps[index(n)] = next;
            open.push_back(n);
        });
    }
    std::vector<std::uint8_t> is_narrow(count, 1);  // by the first column of each strip
    for (const bool is_last : {false, true}) {
        for (std::size_t t = 0; t < count; ++t) {
            std::uint8_t& of_strip = is_narrow[index(strips.find(static_cast<std::int32_t>(t)))];
            if (is_last)
                is_narrow[t] = of_strip;
            else if (steps[t] < 0 || steps[t] > kMostSteps)
                of_strip = 0;
        }
    }
    return is_narrow;
}

}  // namespace realmodel::simulation
