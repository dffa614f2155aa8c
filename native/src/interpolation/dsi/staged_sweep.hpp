// SPDX-License-Identifier: GPL-3.0-or-later
// Several steps over the rows of a matrix while these are in the processor's cache. Private.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace realmodel::interpolation {

/// Steps that each need what the step before left at nearby rows (products with a sparse matrix,
/// one after another) are limited by the speed of memory when each goes through the whole matrix.
/// Here a step follows the one before as closely as the matrix allows, so that its rows are read
/// from memory once for all steps (wavefront blocking: Mohiyuddin and others 2009, "Minimizing
/// communication in sparse matrix solvers"). Each row is reckoned just as without it: the result
/// does not depend on the number of threads.
class StagedSweep {
public:
    static constexpr std::size_t kMostStages = 6;

    /// First and last piece that a piece's rows reach, itself included.
    using Reach = std::pair<std::ptrdiff_t, std::ptrdiff_t>;

    StagedSweep() = default;
    explicit StagedSweep(std::vector<Reach> reach) : reach_(std::move(reach)) {}

    std::ptrdiff_t pieces() const { return static_cast<std::ptrdiff_t>(reach_.size()); }

    /// Calls work(stage, piece) for all pieces and stages 0 .. stages - 1; a stage's work on a
    /// piece may read what the stage before did within the piece's reach. work must not throw.
    template <class Work>
    void run(std::size_t stages, int threads, Work&& work) const;

    /// The same; the sum of what work returns at the last stage, added in the order of the pieces.
    template <class Work>
    double sum(std::size_t stages, int threads, Work&& work) const {
        std::vector<double> sums(reach_.size());
        run(stages, threads, [&](std::size_t stage, std::ptrdiff_t piece) {
            sums[static_cast<std::size_t>(piece)] = work(stage, piece);
        });
        return std::accumulate(sums.begin(), sums.end(), 0.0);
    }

private:
    std::vector<Reach> reach_;
};

template <class Work>
void StagedSweep::run(std::size_t stages, int threads, Work&& work) const {
    constexpr std::ptrdiff_t kWorthAThread = 16;
    const std::ptrdiff_t count = pieces();
    const auto team = static_cast<std::ptrdiff_t>(threads);
#pragma omp parallel num_threads(threads) if (count >= kWorthAThread)
    {
        // The loop has as many turns as threads were asked for: however many there are, all of
        // them are done between two barriers.
        struct Range {
            std::ptrdiff_t begin, end;
            std::array<std::ptrdiff_t, kMostStages> from, next;
        };
        std::vector<Range> mine;
#pragma omp for schedule(static)
        for (std::ptrdiff_t part = 0; part < team; ++part) {
            Range& r = mine.emplace_back();
            r.begin = count * part / team;
            r.end = count * (part + 1) / team;
            // What reaches beyond the range's begin waits for the other threads.
            r.from[0] = r.next[0] = r.begin;
            for (std::size_t s = 1; s < stages; ++s) {
                r.from[s] = r.begin;
                for (std::ptrdiff_t piece = r.begin; piece < r.end; ++piece) {
                    if (reach_[static_cast<std::size_t>(piece)].first < r.from[s - 1])
                        r.from[s] = piece + 1;
                }
                r.next[s] = r.from[s];
            }
            while (r.next[0] < r.end) {
                work(std::size_t{0}, r.next[0]++);
                for (std::size_t s = 1; s < stages; ++s) {
                    while (r.next[s] < r.end &&
                           reach_[static_cast<std::size_t>(r.next[s])].second < r.next[s - 1]) {
                        work(s, r.next[s]++);
                    }
                }
            }
        }
        for (std::size_t s = 1; s < stages; ++s) {
            for (const Range& r : mine) {
                for (std::ptrdiff_t piece = r.begin; piece < r.from[s]; ++piece)
                    work(s, piece);
                for (std::ptrdiff_t piece = r.next[s]; piece < r.end; ++piece)
                    work(s, piece);
            }
#pragma omp barrier
        }
    }
}

}  // namespace realmodel::interpolation
