// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/parallel.hpp"
#include "booleans/exact_division.hpp"
#include "booleans/pieces.hpp"
#include "booleans/snapping.hpp"
#include "exact/sign_filters.hpp"
#include "exact/space_predicates.hpp"

namespace realmodel::booleans {

namespace {

constexpr std::size_t kChunk = 1 << 10;
/// What is nearer than so many units in the last place comes together, twice as many with every
/// time that rounding makes pieces cross.
constexpr double kNearest = 64;
constexpr double kGrowth = 32;
constexpr int kExactRounds = 4;
constexpr int kMostRounds = 40;

/// Divides the surfaces in rounds: first exactly, then where rounding has changed something, until
/// nothing meets out of order.
class Refiner {
public:
    Refiner(const std::array<TriangleMesh, 2>& surfaces, int threads, Progress* progress)
        : pieces_(surfaces, threads, progress), threads_(threads), progress_(progress) {
        for (std::size_t i = 0; i < pieces_.input_count(); ++i)
            fresh_.push_back(static_cast<std::int32_t>(i));
    }

    Parts run();

private:
    void drop_flat();
    bool is_flat(const Corners& corners) const;
    std::vector<PieceId> pieces_near_fresh() const;
    void find_fresh(const std::vector<std::int32_t>& among);
    bool round();
    Parts result() const;

    Pieces pieces_;
    int threads_;
    Progress* progress_;
    std::vector<std::int32_t> fresh_;  ///< triangles of the inputs that have fresh pieces
    bool is_first_ = true;
    double ulps_ = kNearest;
    std::size_t last_meetings_ = SIZE_MAX;  ///< when edges and triangles last got vertices
    int exact_rounds_ = 0;
};

bool Refiner::is_flat(const Corners& c) const {
    if (has_equal_corners(c)) return true;
    const auto& points = pieces_.points;
    const auto &p = points.rounded(c[0]), &q = points.rounded(c[1]), &r = points.rounded(c[2]);
    for (std::size_t u = 0; u < 3; ++u) {
        const std::size_t v = (u + 1) % 3;
        if (exact::orient2d_filter({p[u], p[v]}, {q[u], q[v]}, {r[u], r[v]}).value_or(0) != 0)
            return false;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (exact::orient2d(points, axis, c[0], c[1], c[2]) != 0) return false;
    }
    return true;
}

/// Pieces without area go. As long as nothing is divided, what has a vertex on one of their edges
/// meets another piece there, and gets it; later their edges get it.
void Refiner::drop_flat() {
    for (;;) {
        std::vector<std::vector<Corners>> found(fresh_.size());
        parallel_ranges(fresh_.size(), kChunk, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i) {
                                for (const Piece& piece : pieces_.of(fresh_[i])) {
                                    if (piece.is_fresh && is_flat(piece.corners))
                                        found[i].push_back(in_order(piece.corners).first);
                                }
                            }
                        });
        std::vector<Corners> flat;
        for (std::size_t i = 0; i < fresh_.size(); ++i) {
            flat.insert(flat.end(), found[i].begin(), found[i].end());
            if (is_first_ && !found[i].empty()) pieces_.replace(fresh_[i], {});
        }
        if (is_first_ || flat.empty()) return;
        std::sort(flat.begin(), flat.end());
        flat.erase(std::unique(flat.begin(), flat.end()), flat.end());
        std::vector<std::int32_t> changed = Snapping(pieces_, flat).apply(threads_, progress_);
        changed.insert(changed.end(), fresh_.begin(), fresh_.end());
        std::sort(changed.begin(), changed.end());
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
        find_fresh(changed);
    }
}

/// All pieces that may meet a fresh one, in order.
std::vector<PieceId> Refiner::pieces_near_fresh() const {
    std::vector<PieceId> found;
    std::vector<std::int32_t> inputs;
    if (is_first_) {
        inputs = fresh_;
    } else {
        std::vector<std::vector<std::int32_t>> near((fresh_.size() + 63) / 64);
        parallel_ranges(
            fresh_.size(), 64, threads_, progress_, [&](std::size_t begin, std::size_t end) {
                auto& own = near[begin / 64];
                for (std::size_t i = begin; i < end; ++i) {
                    for (const Piece& piece : pieces_.of(fresh_[i])) {
                        if (!piece.is_fresh) continue;
                        pieces_.find_inputs(pieces_.box(piece.corners),
                                            [&](std::int32_t input) { own.push_back(input); });
                    }
                    std::sort(own.begin(), own.end());
                    own.erase(std::unique(own.begin(), own.end()), own.end());
                }
            });
        for (const auto& some : near)
            inputs.insert(inputs.end(), some.begin(), some.end());
        std::sort(inputs.begin(), inputs.end());
        inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    }
    for (const std::int32_t input : inputs) {
        for (std::size_t k = 0; k < pieces_.of(input).size(); ++k)
            found.push_back({input, static_cast<std::int32_t>(k)});
    }
    return found;
}

void Refiner::find_fresh(const std::vector<std::int32_t>& among) {
    fresh_.clear();
    for (const std::int32_t input : among) {
        const auto own = pieces_.of(input);
        if (std::any_of(own.begin(), own.end(), [](const Piece& p) { return p.is_fresh; }))
            fresh_.push_back(input);
    }
}

/// Divides what meets out of order, or brings it together where it is near. False where nothing
/// does.
bool Refiner::round() {
    drop_flat();
    auto near = pieces_near_fresh();
    std::vector<std::int32_t> inputs, touched;
    for (const PieceId& id : near) {
        if (inputs.empty() || inputs.back() != id.input) inputs.push_back(id.input);
    }
    std::set_union(fresh_.begin(), fresh_.end(), inputs.begin(), inputs.end(),
                   std::back_inserter(touched));
    ExactDivision division(pieces_, std::move(near), threads_, progress_);
    const auto& meetings = division.meetings();
    for (const std::int32_t input : fresh_) {
        for (std::size_t k = 0; k < pieces_.of(input).size(); ++k)
            pieces_[{input, static_cast<std::int32_t>(k)}].is_fresh = false;
    }
    if (meetings.empty()) return false;
    if (is_first_) {
        is_first_ = false;
        division.divide(meetings);
        // a corner that touches a triangle within divides nothing: the next round gives it to that
        for (const auto& met : meetings) {
            if (met.in_one_plane || met.ends[0].to != kNone || met.ends[1].to != kNone ||
                met.ends[0].from != met.ends[1].from)
                continue;
            for (const std::int32_t triangle : {met.one, met.other}) {
                const std::int32_t input = division.piece(triangle).input;
                for (std::size_t k = 0; k < pieces_.of(input).size(); ++k)
                    pieces_[{input, static_cast<std::int32_t>(k)}].is_fresh = true;
            }
        }
        find_fresh(touched);
        return true;
    }
    std::vector<FacetPair> pairs;
    const auto pair_of = [&](const ExactDivision::Meeting& met) {
        FacetPair pair{in_order(pieces_[division.piece(met.one)].corners).first,
                       in_order(pieces_[division.piece(met.other)].corners).first};
        if (pair[1] < pair[0]) std::swap(pair[0], pair[1]);
        return pair;
    };
    for (const auto& met : meetings)
        pairs.push_back(pair_of(met));
    Snapping snapping(pieces_, std::move(pairs), ulps_);
    std::vector<ExactDivision::Meeting> apart;
    for (const auto& met : meetings) {
        const auto at =
            std::lower_bound(snapping.pairs().begin(), snapping.pairs().end(), pair_of(met)) -
            snapping.pairs().begin();
        if (!snapping.is_near()[static_cast<std::size_t>(at)]) {
            apart.push_back(met);
            continue;
        }
        for (const std::int32_t triangle : {met.one, met.other})
            pieces_[division.piece(triangle)].is_fresh = true;
    }
    if (!apart.empty()) {
        if (++exact_rounds_ % kExactRounds == 0) ulps_ *= kGrowth;
    } else if (!snapping.merges()) {
        if (2 * meetings.size() > last_meetings_) ulps_ *= kGrowth;
        last_meetings_ = meetings.size();
    }
    if (!apart.empty()) {
        division.divide(apart);
    } else {
        const auto changed = snapping.apply(threads_, progress_);
        touched.insert(touched.end(), changed.begin(), changed.end());
        std::sort(touched.begin(), touched.end());
        touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    }
    find_fresh(touched);
    return true;
}

Parts Refiner::run() {
    for (int n = 0; n < kMostRounds; ++n) {
        const double share = 0.8 * n / (n + 1.0);
        if (progress_ != nullptr)
            progress_->begin(share, 0.8 * (n + 1) / (n + 2.0), "intersecting triangles");
        if (fresh_.empty() || !round()) return result();
    }
    throw InputError(
        "too_close",
        "the surfaces come so close to each other, again and again, that rounding does "
        "not keep them apart; move one of them a little");
}

Parts Refiner::result() const {
    Parts parts;
    std::vector<std::int32_t> number(pieces_.points.size(), -1);
    for (std::size_t i = 0; i < pieces_.input_count(); ++i) {
        const auto input = static_cast<std::int32_t>(i);
        for (const Piece& piece : pieces_.of(input)) {
            Part part{{}, pieces_.row(input), pieces_.source(input)};
            for (std::size_t k = 0; k < 3; ++k) {
                std::int32_t& own = number[index(piece.corners[k])];
                if (own < 0) {
                    own = checked_number(parts.vertices.size(), "vertices");
                    parts.vertices.push_back(pieces_.points.rounded(piece.corners[k]));
                }
                part.corners[k] = own;
            }
            parts.triangles.push_back(part);
        }
    }
    checked_number(parts.triangles.size(), "triangles");
    return parts;
}

}  // namespace

Parts refine(const std::array<TriangleMesh, 2>& surfaces, int threads, Progress* progress) {
    return Refiner(surfaces, threads, progress).run();
}

}  // namespace realmodel::booleans
