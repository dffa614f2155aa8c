// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/refinement.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "booleans/exact_division.hpp"
#include "booleans/snapping.hpp"
#include "booleans/triangle_pieces.hpp"
#include "exact/orientation.hpp"
#include "exact/space_points.hpp"

namespace realmodel::booleans {

namespace {

constexpr std::size_t kItemsAtOnce = 1 << 10;
/// What is nearer than so many units in the last place comes together, kGrowth times as many where
/// rounds do not settle, but never so many that the shape of the surfaces is lost (5e-7 of a
/// coordinate).
constexpr double kNearest = 64;
constexpr double kGrowth = 32;
constexpr double kFarthest = 0x1p31;
constexpr int kExactRounds = 4, kSnapRounds = 4;  ///< before that
constexpr int kLocalRounds = 16;
constexpr int kMostRounds = 40;
/// Rounds that make so many times the pieces of the first division, and some more, do not settle.
constexpr std::size_t kMostPieces = 16, kFewPieces = 1 << 12;

/// Divides the surfaces in rounds: first exactly, then where rounding has changed something, until
/// nothing meets out of order.
class Refiner {
public:
    Refiner(const std::array<TriangleView, 2>& surfaces, double ulps, const Execution& execution)
        : pieces_(surfaces, execution), execution_(execution), ulps_(ulps) {
        fresh_.resize(pieces_.input_count());
        std::iota(fresh_.begin(), fresh_.end(), 0);
    }

    /// None where rounds do not settle.
    std::optional<RefinedTriangles> run();

private:
    using Numbers = std::vector<std::int32_t>;

    void drop_flat();
    bool is_flat(const TriangleCorners& corners) const;
    std::vector<PieceId> pieces_near_fresh() const;
    void find_fresh(const Numbers& among);
    void set_fresh(const ExactDivision& division, const ExactDivision::Meeting& met) {
        for (const std::int32_t triangle : {met.one, met.other})
            pieces_[division.piece(triangle)].is_fresh = true;
    }
    FacetPair pair_of(const ExactDivision& division, const ExactDivision::Meeting& met) const {
        return booleans::pair_of(pieces_[division.piece(met.one)].corners,
                                 pieces_[division.piece(met.other)].corners);
    }
    bool round();
    bool snap_shallow(ExactDivision& division, Numbers& touched);
    void divide_first(ExactDivision& division);
    void divide_or_snap(ExactDivision& division, Numbers& touched);
    std::vector<std::uint8_t> near_meetings(const ExactDivision& division) const;
    Numbers snap(std::vector<FacetPair>&& pairs);
    RefinedTriangles result() const;

    /// What has been done so far.
    enum class RefinementStage : std::uint8_t {
        kUntouched,  ///< nothing yet
        kSnapped,    ///< what is shallow was brought together
        kDivided,    ///< the inputs were divided along one another
    };

    TrianglePieces pieces_;
    Execution execution_;
    Numbers fresh_;  ///< triangles of the inputs that have fresh pieces
    RefinementStage state_ = RefinementStage::kUntouched;
    double ulps_;
    std::size_t last_meetings_ = SIZE_MAX;  ///< that were brought together
    int exact_rounds_ = 0, snap_rounds_ = 0;
    std::size_t most_pieces_ = SIZE_MAX;
};

bool Refiner::is_flat(const TriangleCorners& c) const {
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
        std::vector<std::vector<TriangleCorners>> flat_pieces(fresh_.size());
        parallel_ranges(fresh_.size(), kItemsAtOnce, execution_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i) {
                                for (const TrianglePiece& piece : pieces_.of(fresh_[i])) {
                                    if (piece.is_fresh && is_flat(piece.corners))
                                        flat_pieces[i].push_back(in_order(piece.corners).first);
                                }
                            }
                        });
        std::vector<TriangleCorners> flat;
        for (std::size_t i = 0; i < fresh_.size(); ++i) {
            flat.insert(flat.end(), flat_pieces[i].begin(), flat_pieces[i].end());
            if (state_ == RefinementStage::kUntouched && !flat_pieces[i].empty())
                pieces_.replace(fresh_[i], {});
        }
        if (state_ == RefinementStage::kUntouched || flat.empty()) return;
        sort_unique(flat);
        Numbers changed = Snapping(pieces_, flat, execution_).apply();
        changed.insert(changed.end(), fresh_.begin(), fresh_.end());
        sort_unique(changed);
        find_fresh(changed);
    }
}

/// All pieces that may meet a fresh one, in order.
std::vector<PieceId> Refiner::pieces_near_fresh() const {
    std::vector<PieceId> near_pieces;
    Numbers inputs;
    if (state_ == RefinementStage::kUntouched) {
        inputs = fresh_;
    } else {
        inputs = collect_ranges<std::int32_t>(
            fresh_.size(), 64, execution_, [&](std::size_t begin, std::size_t end, Numbers& near) {
                for (std::size_t i = begin; i < end; ++i) {
                    for (const TrianglePiece& piece : pieces_.of(fresh_[i])) {
                        if (!piece.is_fresh) continue;
                        pieces_.find_inputs(pieces_.box(piece.corners),
                                            [&](std::int32_t input) { near.push_back(input); });
                    }
                }
                sort_unique(near);
            });
        sort_unique(inputs);
    }
    near_pieces.reserve(inputs.size());
    for (const std::int32_t input : inputs) {
        for (std::size_t k = 0; k < pieces_.of(input).size(); ++k)
            near_pieces.push_back({input, static_cast<std::int32_t>(k)});
    }
    return near_pieces;
}

void Refiner::find_fresh(const Numbers& among) {
    fresh_.clear();
    for (const std::int32_t input : among) {
        const auto pieces = pieces_.of(input);
        if (std::any_of(pieces.begin(), pieces.end(),
                        [](const TrianglePiece& p) { return p.is_fresh; }))
            fresh_.push_back(input);
    }
}

/// Divides what meets out of order, or brings it together where it is near. False where nothing
/// does.
bool Refiner::round() {
    drop_flat();
    auto near = pieces_near_fresh();
    Numbers inputs, touched;
    for (const PieceId& id : near) {
        if (inputs.empty() || inputs.back() != id.input) inputs.push_back(id.input);
    }
    std::set_union(fresh_.begin(), fresh_.end(), inputs.begin(), inputs.end(),
                   std::back_inserter(touched));
    ExactDivision division(pieces_, std::move(near), execution_);
    for (const std::int32_t input : fresh_) {
        for (std::size_t k = 0; k < pieces_.of(input).size(); ++k)
            pieces_[{input, static_cast<std::int32_t>(k)}].is_fresh = false;
    }
    if (division.meetings().empty()) return false;
    if (state_ == RefinementStage::kUntouched && snap_shallow(division, touched)) {
        state_ = RefinementStage::kSnapped;
    } else if (state_ != RefinementStage::kDivided) {
        divide_first(division);
        state_ = RefinementStage::kDivided;
        most_pieces_ = kMostPieces * pieces_.count() + kFewPieces;
    } else {
        divide_or_snap(division, touched);
    }
    sort_unique(touched);
    find_fresh(touched);
    return true;
}

/// Brings together where triangles of the inputs meet in something that doubles cannot keep: new
/// vertices would be rounded, and one of the triangles passes through the other by less than is
/// brought together. Such are the facets of a result and those of its operands. Divided first, they
/// would come out in splinters that cross again once they are rounded.
bool Refiner::snap_shallow(ExactDivision& division, Numbers& touched) {
    const Nearness nearness(pieces_.points, ulps_);
    std::vector<FacetPair> pairs;
    for (const auto& met : division.meetings()) {
        if (execution_.progress != nullptr) execution_.progress->check();  // points take time
        const FacetPair pair = pair_of(division, met);
        if (nearness.is_shallow(pair) && !division.is_in_doubles(met)) pairs.push_back(pair);
    }
    if (pairs.empty()) return false;
    for (const auto& met : division.meetings())
        set_fresh(division, met);
    const auto changed = snap(std::move(pairs));
    touched.insert(touched.end(), changed.begin(), changed.end());
    return !changed.empty();
}

/// Divides the inputs along one another.
void Refiner::divide_first(ExactDivision& division) {
    const auto& meetings = division.meetings();
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
}

/// After rounding: divides where pieces meet that are not near there; else brings all together.
void Refiner::divide_or_snap(ExactDivision& division, Numbers& touched) {
    const auto& meetings = division.meetings();
    const std::vector<std::uint8_t> is_near = near_meetings(division);
    std::vector<ExactDivision::Meeting> apart;
    std::vector<FacetPair> pairs;
    for (std::size_t i = 0; i < meetings.size(); ++i) {
        if (is_near[i] == 0) {
            apart.push_back(meetings[i]);
        } else {
            pairs.push_back(pair_of(division, meetings[i]));
            set_fresh(division, meetings[i]);
        }
    }
    if (apart.empty()) {
        const std::size_t count = pairs.size();
        const auto changed = snap(std::move(pairs));
        touched.insert(touched.end(), changed.begin(), changed.end());
        if (!changed.empty()) {
            if (++snap_rounds_ % kSnapRounds == 0 || count >= last_meetings_)
                ulps_ = std::min(kGrowth * ulps_, kFarthest);
            last_meetings_ = count;
            return;
        }
        apart = meetings;
    }
    if (++exact_rounds_ % kExactRounds == 0) ulps_ = std::min(kGrowth * ulps_, kFarthest);
    division.divide(apart);
}

/// Whether something is near where triangles meet, for all meetings.
std::vector<std::uint8_t> Refiner::near_meetings(const ExactDivision& division) const {
    const auto& meetings = division.meetings();
    const Nearness nearness(pieces_.points, ulps_);
    std::vector<std::uint8_t> is_near(meetings.size());
    parallel_ranges(meetings.size(), kItemsAtOnce, execution_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            NearFeatures features;
                            nearness.find(pair_of(division, meetings[i]), features);
                            is_near[i] = features.empty() ? 0 : 1;
                        }
                    });
    return is_near;
}

/// Brings pairs of facets together, vertices first.
/// @return the triangles of the inputs whose pieces have changed
Refiner::Numbers Refiner::snap(std::vector<FacetPair>&& pairs) {
    Numbers changed;
    while (!pairs.empty()) {
        sort_unique(pairs);
        // first only what does not settle, then all that is near it
        const double of_the_rest = snap_rounds_ < kLocalRounds ? kNearest : ulps_;
        Snapping snapping(pieces_, pairs, {ulps_, of_the_rest}, execution_);
        const auto inputs = snapping.apply();
        changed.insert(changed.end(), inputs.begin(), inputs.end());
        if (!snapping.merges()) break;
        // what remains of the pairs, with the vertices that remain
        std::vector<FacetPair> left;
        for (FacetPair pair : pairs) {
            bool has_area = true;
            for (TriangleCorners& corners : pair) {
                for (SpacePointId& p : corners)
                    p = snapping.merged(p);
                has_area = has_area && !has_equal_corners(corners);
            }
            if (has_area) left.push_back(booleans::pair_of(pair[0], pair[1]));
        }
        std::erase_if(left, [](const FacetPair& pair) { return pair[0] == pair[1]; });
        pairs = std::move(left);
    }
    sort_unique(changed);
    return changed;
}

std::optional<RefinedTriangles> Refiner::run() {
    for (int n = 0; n < kMostRounds && pieces_.count() <= most_pieces_; ++n) {
        const auto share = [](double rounds) { return 0.02 + 0.78 * rounds / (rounds + 1); };
        begin_phase(execution_.progress, share(n), share(n + 1), "intersecting triangles");
        if (fresh_.empty() || !round()) return result();
    }
    return std::nullopt;
}

RefinedTriangles Refiner::result() const {
    RefinedTriangles refined;
    refined.vertices.reserve(pieces_.points.size());
    refined.triangles.reserve(pieces_.count());
    std::vector<std::int32_t> number(pieces_.points.size(), -1);
    for (std::size_t i = 0; i < pieces_.input_count(); ++i) {
        poll(execution_.progress, i);
        const auto input = static_cast<std::int32_t>(i);
        for (const TrianglePiece& piece : pieces_.of(input)) {
            assert(!piece.is_fresh && !has_equal_corners(piece.corners));
            RefinedTriangle refined_triangle{{}, pieces_.row(input), pieces_.source(input)};
            for (std::size_t k = 0; k < 3; ++k) {
                std::int32_t& vertex = number[index(piece.corners[k])];
                if (vertex < 0) {
                    vertex = checked_number(refined.vertices.size(), "vertices");
                    refined.vertices.push_back(pieces_.points.rounded(piece.corners[k]));
                }
                refined_triangle.corners[k] = vertex;
            }
            refined.triangles.push_back(refined_triangle);
        }
    }
    checked_number(refined.triangles.size(), "triangles");
    return refined;
}

}  // namespace

RefinedTriangles refine(const std::array<TriangleView, 2>& surfaces, const Execution& execution) {
    // surfaces that are farther apart than what is brought together first may cross in splinters
    // that never settle: then more is brought together first
    for (double ulps = kNearest; ulps <= kFarthest; ulps *= kGrowth * kGrowth) {
        if (auto triangles = Refiner(surfaces, ulps, execution).run()) return std::move(*triangles);
    }
    throw InputError(
        "too_close",
        "the surfaces come so close to each other, again and again, that rounding does "
        "not keep them apart; move one of them a little");
}

}  // namespace realmodel::booleans
