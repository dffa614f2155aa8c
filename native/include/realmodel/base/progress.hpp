// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>

namespace realmodel {

/// Where a long computation stands, and the wish of its caller to stop it.
///
/// The computation reports and checks from any of its threads while another thread watches and
/// cancels; every member may be called at any time.
class Progress {
public:
    Progress() = default;
    /// Of a part of some work: how far it is takes that work on by `share` of it, and it is
    /// cancelled with it. Several parts may be under way at once.
    /// @param whole  the work, which outlives its part; null: nobody watches it
    Progress(Progress* whole, double share) : whole_(whole), share_(share) {}

    /// Says how far the work is.
    /// @param fraction  share of the work done; kept within 0 .. 1, NaN is left out
    /// @param text      what is being done, UTF-8, copied (what is longer than 127 bytes is cut);
    ///                  null keeps the text that was there
    void report(double fraction, const char* text) noexcept;

    /// Begins a part of the work, which takes the fraction from `start` to `end`. Loops that count
    /// their rounds (CountedLoop) move it on in between, whoever runs them.
    /// @param start, end  kept within 0 .. 1
    /// @param text        as for report()
    void begin(double start, double end, const char* text) noexcept;

    /// Asks the computation to stop; it does so at its next check(). The work that it is a part of
    /// goes on.
    void cancel() noexcept;
    bool cancelled() const noexcept;

    /// @throws Cancelled once cancel() was called. In an OpenMP region only within the chunks of
    ///         the loops of base/parallel.hpp, which no exception leaves.
    void check() const;

    double fraction() const noexcept;
    std::string text() const;

private:
    friend class CountedLoop;
    void advance(double fraction) noexcept;
    void take_on_whole(double fraction) noexcept;

    Progress* whole_ = nullptr;
    double share_ = 0.0;
    std::atomic<double> passed_on_{0.0};  ///< the fraction that the whole knows of
    std::atomic<double> fraction_{0.0};
    std::atomic<double> phase_end_{0.0};
    std::atomic<bool> cancelled_{false};
    mutable std::mutex text_mutex_;
    std::array<char, 128> text_{};  // fixed, so that report() cannot fail for want of memory
};

/// Counts the rounds of a loop into the part of the work that was begun last. How many loops make a
/// part, and what each costs, need not be known: a loop takes a share of what is left of the part,
/// so that the fraction never falls and never passes the end of the part. What a fraction means in
/// time is measured (scripts/benchmark.sh) and applied by the caller.
class CountedLoop {
public:
    /// @param progress  null: nothing is counted
    /// @param rounds    how many there will be
    /// @param share     of what is left of the part, 0 .. 1
    CountedLoop(Progress* progress, std::size_t rounds, double share = 0.5) noexcept;
    /// One round more is done. From any thread.
    void count() noexcept;

private:
    Progress* progress_;
    double from_ = 0.0, step_ = 0.0;
    std::atomic<std::size_t> done_{0};
};

}  // namespace realmodel
