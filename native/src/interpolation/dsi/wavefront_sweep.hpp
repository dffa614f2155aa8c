// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.hpp"

namespace realmodel::interpolation {

using Vector = std::vector<double>;

inline constexpr std::size_t kVectorPiece = 4096;

/// Calls work(begin, end) for pieces of [0, count). What is short is done before threads have met.
template <class Work>
void in_pieces(std::size_t count, int threads, const Work& work) {
    const std::size_t pieces = (count + kVectorPiece - 1) / kVectorPiece;
    parallel_even(pieces, pieces > 16 ? threads : 1, [&](std::size_t piece) {
        work(piece * kVectorPiece, std::min(count, (piece + 1) * kVectorPiece));
    });
}

/// Calls work(row) for [0, count); each row is work enough for a thread.
template <class Work>
void for_rows(std::size_t count, int threads, const Work& work) {
    parallel_even(count, count > 64 ? threads : 1, work);
}

/// Sums of fixed pieces, added in their order: the same bytes for any number of threads.
inline double dot(std::span<const double> a, std::span<const double> b, int threads) {
    assert(a.size() == b.size());
    std::vector<double> sums((a.size() + kVectorPiece - 1) / kVectorPiece);
    in_pieces(a.size(), threads, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            sum += a[i] * b[i];
        sums[begin / kVectorPiece] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Several steps over the rows of a matrix while these are in the processor's cache. Steps that
/// each need what the step before left at nearby rows (products with a sparse matrix, one after
/// another) are limited by the speed of memory when each goes through the whole matrix. Here a step
/// follows the one before as closely as the matrix allows, so that its rows are read from memory
/// once for all steps (wavefront blocking: Mohiyuddin and others 2009, "Minimizing communication in
/// sparse matrix solvers"). Each row is computed just as without it: the result does not depend on
/// the number of threads.
class WavefrontSweep {
public:
    static constexpr std::size_t kMostStages = 6;

    /// First and last piece that a piece's rows reach, itself included.
    using Reach = std::pair<std::ptrdiff_t, std::ptrdiff_t>;

    WavefrontSweep() = default;
    explicit WavefrontSweep(std::vector<Reach> reach) : reach_(std::move(reach)) {}

    std::ptrdiff_t pieces() const { return std::ssize(reach_); }

    /// Calls work(stage, piece) for all pieces and stages 0 .. stages - 1; a stage's work on a
    /// piece may read what the stage before did within the piece's reach.
    template <class Work>
    void run(std::size_t stages, int threads, const Work& work) const;

    /// The same; the sum of what work returns at the last stage, added in the order of the pieces.
    template <class Work>
    double sum(std::size_t stages, int threads, const Work& work) const {
        std::vector<double> sums(reach_.size());
        run(stages, threads,
            [&](std::size_t stage, std::ptrdiff_t piece) { sums[piece] = work(stage, piece); });
        return std::accumulate(sums.begin(), sums.end(), 0.0);
    }

private:
    /// What one thread does of all stages before the threads meet: of stage s the pieces from[s] to
    /// next[s] - 1.
    struct SweepRange {
        std::ptrdiff_t begin, end;
        std::array<std::ptrdiff_t, kMostStages> from, next;
    };
    template <class Work>
    SweepRange run_ahead(std::ptrdiff_t begin, std::ptrdiff_t end, std::size_t stages,
                         const Work& work) const;

    std::vector<Reach> reach_;
};

template <class Work>
WavefrontSweep::SweepRange WavefrontSweep::run_ahead(std::ptrdiff_t begin, std::ptrdiff_t end,
                                                     std::size_t stages, const Work& work) const {
    SweepRange r{begin, end, {}, {}};
    r.from[0] = r.next[0] = begin;
    for (std::size_t s = 1; s < stages; ++s) {
        r.from[s] = begin;  // pieces that reach beyond the begin wait for the other threads
        for (std::ptrdiff_t piece = begin; piece < end; ++piece) {
            if (reach_[piece].first < r.from[s - 1]) r.from[s] = piece + 1;
        }
        r.next[s] = r.from[s];
    }
    while (r.next[0] < end) {
        work(std::size_t{0}, r.next[0]++);
        for (std::size_t s = 1; s < stages; ++s) {
            while (r.next[s] < end && reach_[r.next[s]].second < r.next[s - 1])
                work(s, r.next[s]++);
        }
    }
    return r;
}

template <class Work>
void WavefrontSweep::run(std::size_t stages, int threads, const Work& work) const {
    constexpr std::ptrdiff_t kWorthAThread = 16;
    assert(stages >= 1 && stages <= kMostStages);
    const std::ptrdiff_t count = pieces(), team = count >= kWorthAThread ? threads : 1;
    std::vector<SweepRange> ranges(static_cast<std::size_t>(team));
    parallel_even(ranges.size(), threads, [&](std::size_t worker) {
        const auto number = static_cast<std::ptrdiff_t>(worker);
        ranges[worker] =
            run_ahead(count * number / team, count * (number + 1) / team, stages, work);
    });
    for (std::size_t s = 1; s < stages; ++s) {
        parallel_even(ranges.size(), threads, [&](std::size_t worker) {
            const SweepRange& r = ranges[worker];
            for (std::ptrdiff_t piece = r.begin; piece < r.from[s]; ++piece)
                work(s, piece);
            for (std::ptrdiff_t piece = r.next[s]; piece < r.end; ++piece)
                work(s, piece);
        });
    }
}

}  // namespace realmodel::interpolation
