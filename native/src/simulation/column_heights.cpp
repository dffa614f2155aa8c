// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/column_heights.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::size_t kFacesOfChunk = 4096;

struct Hit {
    std::int32_t point, below, above, surface;
    double height;
};

/// Twice the area in plan, counter-clockwise, and the box of a face.
struct PlanShape {
    double area = 0;
    spatial::PlanBox box = spatial::kNoBox;

    PlanShape(const ComplexView& model, std::span<const std::int32_t> loop) {
        const auto origin = model.vertex(loop[0]);
        auto last = model.vertex(loop.back());
        for (const std::int32_t v : loop) {
            const auto p = model.vertex(v);
            area += (last[0] - origin[0]) * (p[1] - origin[1]) -
                    (last[1] - origin[1]) * (p[0] - origin[0]);
            box = box.united({p[0], p[1], p[0], p[1]});
            last = p;
        }
    }
    bool is_vertical() const {
        return std::abs(area) <=
               1e-14 * (box.width() + box.height()) * (box.width() + box.height());
    }
};

/// Whether a point lies in a polygon, exactly; on the border of two it lies in one of them.
bool contains(const ComplexView& model, std::span<const std::int32_t> loop, const PlanPoint& p) {
    int turns = 0;
    PlanPoint a = plan_of(model, loop.back());
    for (const std::int32_t v : loop) {
        const PlanPoint b = plan_of(model, v);
        if (a[1] <= p[1]) {
            if (b[1] > p[1] && exact::orient2d(a, b, p) > 0) ++turns;
        } else if (b[1] <= p[1] && exact::orient2d(a, b, p) < 0) {
            --turns;
        }
        a = b;
    }
    return turns != 0;
}

/// The height of a face's plane, given by the largest triangle of its fan, within its own heights.
double height(const ComplexView& model, std::span<const std::int32_t> loop, const PlanPoint& p) {
    const auto o = model.vertex(loop[0]);
    double low = o[2], high = o[2], largest = 0, at = o[2];
    for (std::size_t i = 1; i < loop.size(); ++i) {
        const auto b = model.vertex(loop[i]);
        low = std::min(low, b[2]);
        high = std::max(high, b[2]);
        if (i + 1 == loop.size()) break;
        const auto c = model.vertex(loop[i + 1]);
        const Vec2 u{b[0] - o[0], b[1] - o[1]}, v{c[0] - o[0], c[1] - o[1]};
        const double area = cross(u, v);
        if (std::abs(area) <= largest) continue;
        largest = std::abs(area);
        const Vec2 w{p[0] - o[0], p[1] - o[1]};
        at = o[2] + cross(w, v) / area * (b[2] - o[2]) + cross(u, w) / area * (c[2] - o[2]);
    }
    return std::clamp(at, low, high);
}

/// What vertical lines through points meet, by points.
Buckets<Hit> hits_of(const ComplexView& model, std::span<const PlanPoint> points,
                     const Execution& execution) {
    const spatial::PointBins bins(std::vector<PlanPoint>(points.begin(), points.end()));
    const std::size_t chunks = (model.face_count() + kFacesOfChunk - 1) / kFacesOfChunk;
    std::vector<std::vector<Hit>> hits(chunks);
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        const std::size_t end = std::min(model.face_count(), (chunk + 1) * kFacesOfChunk);
        for (std::size_t f = chunk * kFacesOfChunk; f < end; ++f) {
            if (model.face_surface[f] == kWall) continue;
            std::int32_t below = model.block(model.cell(f, 0)),
                         above = model.block(model.cell(f, 1));
            if (below == above) continue;
            const auto loop = model.face(f);
            const PlanShape shape(model, loop);
            if (shape.is_vertical()) continue;
            if (shape.area < 0) std::swap(below, above);
            bins.within(shape.box, [&](std::size_t i, const PlanPoint& p) {
                if (contains(model, loop, p))
                    hits[chunk].push_back({static_cast<std::int32_t>(i), below, above,
                                           model.face_surface[f], height(model, loop, p)});
            });
        }
    });
    return bucketize<Hit>(points.size(), [&](const auto& put) {
        for (const auto& hits_of_chunk : hits) {
            for (const Hit& hit : hits_of_chunk)
                put(index(hit.point), hit);
        }
    });
}

/// The blocks of one rock mass on one vertical line: the faces at their tops and bottoms.
class Stack {
public:
    /// False where a block has several tops or bottoms, or is of another rock mass.
    bool take(std::span<const Hit> hits, const RockBlocks& blocks, std::int32_t rock) {
        const std::int32_t first = blocks.first[index(rock)];
        const auto count = index(blocks.blocks_of(rock));
        top_.assign(count, nullptr);
        bottom_.assign(count, nullptr);
        for (const Hit& hit : hits) {
            for (const bool is_top : {true, false}) {
                const std::int32_t block = is_top ? hit.below : hit.above;
                if (block < 0) continue;
                const auto at = static_cast<std::size_t>(block - first);
                if (block < first || at >= count) return false;
                const Hit*& boundary = (is_top ? top_ : bottom_)[at];
                if (boundary != nullptr) return false;
                boundary = &hit;
            }
        }
        return true;
    }

    /// False where a block has a top alone or a bottom alone, or does not lie on the next.
    bool write(std::span<double> z, std::span<std::int32_t> surface) const {
        const Hit* under = nullptr;  // the face between the last block present and what follows
        std::size_t level = 0;
        for (std::size_t b = 0; b < top_.size(); ++b) {
            if (top_[b] == nullptr && bottom_[b] == nullptr) continue;
            if (top_[b] == nullptr || bottom_[b] == nullptr ||
                (under != nullptr && bottom_[b] != under))
                return false;
            for (; level <= b; ++level) {
                z[level] = bottom_[b]->height;
                surface[level] = bottom_[b]->surface;
            }
            under = top_[b];
            z[level] = std::max(under->height, z[level - 1]);
            surface[level] = under->surface;
            ++level;
        }
        if (under == nullptr) return false;
        for (; level < z.size(); ++level) {
            z[level] = z[level - 1];
            surface[level] = surface[level - 1];
        }
        return true;
    }

private:
    std::vector<const Hit*> top_, bottom_;  ///< of each block; null: it has none
};

}  // namespace

RockBlocks::RockBlocks(std::span<const std::int32_t> block_rock)
    : first{0}, rock(block_rock.begin(), block_rock.end()) {
    std::int32_t block = 0;
    for (const std::int32_t of : rock) {
        while (static_cast<std::int32_t>(first.size()) <= of)
            first.push_back(block);
        if (of + 1 != static_cast<std::int32_t>(first.size()))
            throw InputError("bad_index", "blocks of one rock mass must stand together", -1,
                             {block});
        ++block;
    }
    first.push_back(block);
}

std::int32_t RockBlocks::blocks_of(std::int32_t of_rock) const {
    return first[index(of_rock) + 1] - first[index(of_rock)];
}

std::int32_t RockBlocks::most() const {
    std::int32_t most = 0;
    for (std::size_t r = 0; r < count(); ++r)
        most = std::max(most, blocks_of(static_cast<std::int32_t>(r)));
    return most;
}

bool is_vertical(const ComplexView& model, std::size_t face) {
    return model.face_surface[face] == kWall || PlanShape(model, model.face(face)).is_vertical();
}

bool faces_up(const ComplexView& model, std::size_t face) {
    return PlanShape(model, model.face(face)).area > 0;
}

ColumnHeights::ColumnHeights(const ComplexView& model, const RockBlocks& blocks,
                             std::span<const PlanPoint> points, const Execution& execution)
    : stride_(index(blocks.most()) + 1),
      rock_(points.size(), kOutside),
      height_(points.size() * stride_),
      surface_(points.size() * stride_) {
    if (points.empty()) return;
    const Buckets<Hit> hits = hits_of(model, points, execution);
    parallel_ranges(points.size(), 4096, execution, [&](std::size_t begin, std::size_t end) {
        Stack stack;
        for (std::size_t i = begin; i < end; ++i) {
            if (hits[i].empty()) continue;
            const std::int32_t any = std::max(hits[i][0].below, hits[i][0].above);
            rock_[i] = blocks.rock[index(any)];
            if (!stack.take(hits[i], blocks, rock_[i]) ||
                !stack.write({&height_[i * stride_], stride_}, {&surface_[i * stride_], stride_}))
                rock_[i] = kIncomplete;
        }
    });
}

void ColumnHeights::copy(std::size_t to, const ColumnHeights& other, std::size_t from) {
    rock_[to] = other.rock_[from];
    std::copy_n(&other.height_[from * stride_], stride_, &height_[to * stride_]);
    std::copy_n(&other.surface_[from * stride_], stride_, &surface_[to * stride_]);
}

namespace {

/// How much of the way from a to b is free of steps: 1 if all of it is, but for b itself.
double free_way(const PlanLines& lines, const spatial::BoxTree& step_tree, const PlanPoint& a,
                const PlanPoint& b) {
    double free = 1;
    step_tree.find(spatial::bounding_box(std::array{a, b}), [&](std::int32_t s) {
        const auto& [p, q] = lines.steps[index(s)];
        if (exact::orient2d(a, b, p) * exact::orient2d(a, b, q) > 0) return;
        const int from = exact::orient2d(p, q, a), to = exact::orient2d(p, q, b);
        if (from * to > 0 || (from == 0 && to == 0)) return;
        const double off = std::abs(twice_area(p, q, a));
        const double whole = off + std::abs(twice_area(p, q, b));
        if (whole > 0) free = std::min(free, off / whole);
    });
    return free;
}

PlanPoint between(const PlanPoint& a, const PlanPoint& b, double share) {
    if (share == 1) return b;
    return moved(a, share, minus(b, a));
}

/// Where the model is asked for the heights of each pillar.
class PillarPositions {
public:
    PillarPositions(const PlanLines& lines, const PlanTopology& plan)
        : plan_(plan),
          is_beside_(plan.pillar_count(), 0),
          center_(plan.pillar_count()),
          free_(plan.pillar_count(), -1) {
        const spatial::BoxTree step_tree = tree_in_plan(lines.steps);
        find_beside();
        for (std::size_t p = 0; p < center_.size(); ++p)
            center_[p] = node(p);
        // of the triangles around a pillar the one that is best seen from its node
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            const auto [a, b, c] = plan.corners(t);
            const PlanPoint middle = middle_of(plan.point(a), plan.point(b), plan.point(c));
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t p = plan.pillar(t, i);
                if (free_[p] >= 1) continue;
                const double free_share =
                    is_beside_[p] != 0 ? free_way(lines, step_tree, middle, node(p)) : 1;
                if (free_share <= free_[p]) continue;
                free_[p] = free_share;
                center_[p] = middle;
            }
        }
    }

    /// At the node, or beside a step or the border as near to it as the way is free.
    PlanPoint nearest(std::size_t pillar) const {
        constexpr double kBesideStep = 1 - 1e-9;
        return is_beside_[pillar] == 0
                   ? node(pillar)
                   : between(center_[pillar], node(pillar), free_[pillar] * kBesideStep);
    }
    /// Part of the way to there, from the middle of a triangle.
    PlanPoint farther(std::size_t pillar, double share) const {
        return between(center_[pillar], node(pillar), std::max(free_[pillar], 0.0) * share);
    }

private:
    const PlanPoint& node(std::size_t pillar) const {
        return plan_.point(plan_.pillar_node(pillar));
    }

    void find_beside() {
        std::vector<std::uint8_t> is_beside(plan_.nodes(), 0);
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (plan_.neighbor(t, i) < 0 || plan_.is_inner_step(t, i))
                    is_beside[index(plan_.corners(t)[i])] =
                        is_beside[index(plan_.corners(t)[(i + 1) % 3])] = 1;
            }
        }
        for (std::size_t p = 0; p < is_beside_.size(); ++p)
            is_beside_[p] = is_beside[index(plan_.pillar_node(p))];
    }

    const PlanTopology& plan_;
    std::vector<std::uint8_t> is_beside_;  ///< a step or the border
    std::vector<PlanPoint> center_;        ///< the middle of a triangle at the pillar
    std::vector<double> free_;             ///< how much of the way from there to the node is
};

/// What a simplified border added to the region is as beside it.
template <class IsSettled>
void copy_from_neighbors(const PlanTopology& plan, const IsSettled& is_settled,
                         ColumnHeights& columns) {
    for (bool any = true; any;) {
        any = false;
        std::vector<std::pair<std::size_t, std::size_t>> copies;
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t pillar = plan.pillar(t, i);
                if (is_settled(pillar)) continue;
                for (std::size_t k = 1; k < 3; ++k) {
                    const std::size_t other = plan.pillar(t, (i + k) % 3);
                    if (!is_settled(other)) continue;
                    copies.emplace_back(pillar, other);
                    break;
                }
            }
        }
        for (const auto& [to, from] : copies) {
            if (is_settled(to)) continue;
            columns.copy(to, columns, from);
            any = true;
        }
    }
}

}  // namespace

ColumnHeights pillar_columns(const ComplexView& model, const RockBlocks& blocks,
                             const PlanLines& lines, const PlanTopology& plan,
                             const Execution& execution) {
    const std::size_t count = plan.pillar_count();
    const PillarPositions positions(lines, plan);
    std::vector<std::int32_t> rock(count, -1);
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i)
            rock[plan.pillar(t, i)] = plan.rock(t);
    }
    std::vector<std::size_t> open(count);
    std::vector<PlanPoint> asked(count);
    for (std::size_t p = 0; p < count; ++p) {
        open[p] = p;
        asked[p] = positions.nearest(p);
    }
    ColumnHeights columns(model, blocks, asked, execution);
    const auto is_settled = [&](std::size_t p) {
        return columns.rock(p) == rock[p] && rock[p] >= 0;
    };
    // where rounding, or a border that was simplified, leaves nothing: farther from the node
    for (const double share : {1 - 1e-6, 0.99, 0.9, 0.7, 0.4, 0.0}) {
        std::erase_if(open, is_settled);
        if (open.empty()) return columns;
        asked.clear();
        for (const std::size_t p : open)
            asked.push_back(positions.farther(p, share));
        const ColumnHeights farther_columns(model, blocks, asked, execution);
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (farther_columns.rock(i) == rock[open[i]]) columns.copy(open[i], farther_columns, i);
        }
    }
    copy_from_neighbors(plan, is_settled, columns);
    return columns;
}

}  // namespace realmodel::simulation
