// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// Commits the local lines and points of many chunks in the order of the chunks, whichever is
/// finished first, by whatever thread is free while others still work: the ids do not depend on
/// threads, and nobody waits for more than the counting of ids.
class OrderedCommit {
public:
    /// `facets`: those of all chunks.
    OrderedCommit(exact::PlanArrangement& geometry, std::size_t chunks, std::size_t facets)
        : geometry_(geometry), finished_(chunks) {
        // What others read must not move. Most facets find fewer lines and points than this; where
        // one finds more, the rest waits until all are done.
        geometry.make_room(facets * 4 + 1024, facets * 8 + 1024);
    }

    /// Chunks from `first` to `last` - 1.
    struct Chunks {
        std::size_t first = 0, last = 0;
    };
    struct Nothing {
        void operator()(std::size_t) const {}
    };

    /// To be called when nothing more will be found in the local arrangement of a chunk. `passed`
    /// is called with each chunk that has its ids, in order, by one thread at a time.
    /// @return the chunks that this call committed, which may be none or other ones
    template <class Passed = Nothing>
    Chunks finished(std::size_t chunk, LocalArrangement& local, const Passed& passed = {}) {
        return commit([&] { finished_[chunk] = &local; },
                      [&](const LocalArrangement& next) { return next.has_room_in(geometry_); },
                      passed);
    }

    /// To be called when all chunks are finished: commits what is left, and returns it.
    template <class Passed = Nothing>
    Chunks finish(const Passed& passed = {}) {
        return commit([] {}, [](const LocalArrangement&) { return true; }, passed);
    }

private:
    template <class Begin, class MayCommit, class Passed>
    Chunks commit(const Begin& begin, const MayCommit& may_commit, const Passed& passed) {
        Chunks chunks;
        {
            const std::lock_guard lock(busy_);
            begin();
            chunks.first = next_;
            for (; next_ < finished_.size() && finished_[next_] != nullptr &&
                   may_commit(*finished_[next_]);
                 ++next_) {
                finished_[next_]->reserve_ids(geometry_);
                passed(next_);
            }
            chunks.last = next_;
        }
        for (std::size_t c = chunks.first; c < chunks.last; ++c)
            finished_[c]->write_marked();
        return chunks;
    }

    exact::PlanArrangement& geometry_;
    std::vector<LocalArrangement*> finished_;  ///< of each chunk that is; with busy_
    std::mutex busy_;
    std::size_t next_ = 0;  ///< chunk to be committed; with busy_
};

}  // namespace realmodel::strata
