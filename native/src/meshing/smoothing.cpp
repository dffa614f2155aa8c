// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/improvement.hpp"

namespace realmodel::meshing {

namespace {

constexpr int kRounds = 4;
constexpr int kJudgedRounds = 2;  // later ones find next to nothing
constexpr int kMovesPerRound = 1;
constexpr int kLastMoves = 4;
constexpr int kFlipsOfAGlide = 8;
constexpr std::size_t kManyActive = 200'000;

class Smoothing {
public:
    Smoothing(FlatMesh& mesh, SizeField& size, std::int32_t first,
              std::span<const std::int32_t> also, std::int32_t corners,
              std::span<const std::int32_t> fixed)
        : mesh_(mesh),
          size_(size),
          valences_(mesh, size),
          moves_(valences_),
          flips_(valences_, moves_) {
        for (const std::int32_t v : fixed)
            valences_.keep(v);
        // Of one length pieces stay even: regions edge by edge meet in them.
        if (!size_.is_uniform()) find_sliding(corners);
        find_active(first, also);
    }

    void run(const Check& check) {
        Ticker tick(check);
        for (int round = 0; round < kRounds; ++round) {
            flip_towards_six(tick);
            collapse_towards_six(tick);
            if (round < kJudgedRounds) glide(check);
            for (int i = 0; i < kMovesPerRound; ++i)
                move_all(tick);
            make_delaunay(tick);
            if (round == 0) leave_strips();
            if (round < kJudgedRounds) mend(check);
        }
        for (int i = 0; i < kLastMoves; ++i)
            move_all(tick);
        make_delaunay(tick);
        move_all(tick);
        make_delaunay(tick);
    }

private:
    void find_active(std::int32_t first, std::span<const std::int32_t> also) {
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        std::vector<bool> near(mesh_.points.size(), false);
        const auto take = [&](std::int32_t t) {
            for (const std::int32_t v : mesh_.corners[t])
                near[v] = true;
        };
        for (std::int32_t t = first; t < count; ++t)
            if (!mesh_.is_dead(t)) take(t);
        for (const std::int32_t t : also)
            take(t);
        for (int ring = 0; ring < 2; ++ring) {
            std::vector<std::int32_t> more;
            for (std::int32_t t = 0; t < first; ++t) {
                const auto& c = mesh_.corners[t];
                if (near[c[0]] || near[c[1]] || near[c[2]]) more.push_back(t);
            }
            for (const std::int32_t t : more)
                take(t);
        }
        const auto points = static_cast<std::int32_t>(mesh_.points.size());
        for (std::int32_t v = 0; v < points; ++v) {
            if (!near[v] || valences_.is_gone(v)) continue;
            if (moves_.slides(v)) active_.push_back(v);
            if (valences_.is_fixed(v)) continue;
            moves_.free(v);
            active_.push_back(v);
        }
    }

    /// Vertices added between two corners of the border may slide between them.
    void find_sliding(std::int32_t corners) {
        const std::size_t points = mesh_.points.size();
        std::vector<HalfEdge> border(points, HalfEdge::none());  // of each added vertex: from it
        std::vector<HalfEdge> begins;
        mesh_.for_each_edge([&](HalfEdge edge) {
            if (!mesh_.is_border(edge)) return;
            if (mesh_.from(edge) >= corners) {
                border[mesh_.from(edge)] = edge;
            } else if (mesh_.to(edge) >= corners) {
                begins.push_back(edge);
            }
        });
        for (const HalfEdge begin : begins) {
            std::int32_t end = mesh_.to(begin);
            while (end >= corners)
                end = mesh_.to(border[end]);
            const std::int32_t line = moves_.add_line(mesh_.origin_point(begin), mesh_.points[end]);
            HalfEdge before = begin;
            for (std::int32_t v = mesh_.to(begin); v >= corners; v = mesh_.to(before)) {
                if (!mesh_.is_locked(before) && !mesh_.is_locked(border[v])) {
                    moves_.slide_on(v, line);
                }
                before = border[v];
            }
        }
    }

    /// Strips, where the border has no room for vertices inside, take most of the time and gain
    /// least (0.03 of the mean ratio): where there are very many, the first round must do.
    void leave_strips() {
        if (active_.size() < kManyActive) return;
        std::erase_if(active_, [&](std::int32_t v) {
            bool is_free = moves_.moves_freely(v);
            if (valences_.is_gone(v)) return true;
            valences_.around(v, [&](HalfEdge edge) {
                is_free = is_free || moves_.moves_freely(mesh_.to(edge));
            });
            return !is_free;
        });
    }

    void flip_towards_six(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.2);
            if (valences_.is_gone(v)) continue;
            edges_.clear();
            valences_.around(v, [&](HalfEdge edge) { edges_.push_back(edge); });
            for (const HalfEdge edge : edges_) {
                if (mesh_.is_fixed(edge)) continue;
                if (valences_.gain_of_flip(edge) <= 0) continue;
                if (!valences_.can_flip(edge)) continue;
                valences_.flip(edge);
                break;  // the star has changed
            }
        }
    }

    void collapse_towards_six(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.3);
            if (valences_.is_gone(v)) continue;
            if (moves_.slides(v)) valences_.remove_from_border(v);
            if (moves_.moves_freely(v)) valences_.collapse(v);
        }
    }

    void glide(const Check& check) {
        Ticker tick(check, 32);  // a vertex may look at a hundred flips
        for (const std::int32_t v : active_) {
            if (valences_.is_gone(v) || !moves_.moves_freely(v) || valences_.is_regular(v)) {
                continue;
            }
            tick(0.5);
            flips_.glide(v, kFlipsOfAGlide);
        }
    }

    void mend(const Check& check) {
        Ticker tick(check, 1024);
        for (const std::int32_t v : active_) {
            tick(0.7);
            if (!valences_.is_gone(v)) flips_.mend(v);
        }
    }

    void move_all(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.6);
            if (!valences_.is_gone(v)) moves_.move(v);
        }
    }

    void make_delaunay(Ticker& tick) {
        std::vector<HalfEdge>& open = edges_;
        for (const std::int32_t v : active_) {
            tick(0.8);
            if (valences_.is_gone(v)) continue;
            open.clear();
            valences_.around(v, [&](HalfEdge edge) {
                open.push_back(edge);
                open.push_back(edge.next());
            });
            mesh_.legalize(open, [this](HalfEdge edge) { return valences_.flip(edge); });
        }
    }

    FlatMesh& mesh_;
    SizeField& size_;
    Valences valences_;
    StarMoves moves_;
    JudgedFlips flips_;
    std::vector<std::int32_t> active_;
    std::vector<HalfEdge> edges_;
};

}  // namespace

void smooth(FlatMesh& mesh, SizeField& size, std::int32_t first, std::span<const std::int32_t> also,
            std::int32_t corners, std::span<const std::int32_t> fixed, const Check& check) {
    Smoothing(mesh, size, first, also, corners, fixed).run(check);
}

}  // namespace realmodel::meshing
