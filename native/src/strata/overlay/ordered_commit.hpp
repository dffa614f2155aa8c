// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

#include "strata/overlay/polygon.hpp"

namespace realmodel::strata {

/// Commits what the scopes of many chunks found to the geometry, in the order of the chunks
/// whichever comes first, by whatever thread is free while others still work: the ids do not depend
/// on threads, and nobody waits.
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

    /// For callers to whom it does not matter when a chunk is committed.
    struct Nothing {
        void operator()(std::size_t) const {}
    };

    /// To be called when nothing more will be asked of the scope of a chunk. `passed` is called
    /// with each chunk that is committed, in order.
    /// @return the chunks that this call committed, which may be none or other ones: their scopes
    /// are the caller's again
    template <class Passed = Nothing>
    Chunks finished(std::size_t chunk, LocalArrangement& scope, const Passed& passed = {}) {
        finished_[chunk].store(&scope, std::memory_order_release);
        const std::unique_lock lock(busy_, std::try_to_lock);
        if (!lock) return {};  // another thread goes on, now or with its next chunk
        const std::size_t first = next_;
        for (LocalArrangement* next = finished_scope();
             next != nullptr && next->has_room_in(geometry_); next = finished_scope())
            commit(*next, passed);
        return {first, next_};
    }

    /// To be called when all chunks are finished: commits what is left, and returns it.
    template <class Passed = Nothing>
    Chunks finish(const Passed& passed = {}) {
        const std::size_t first = next_;
        for (LocalArrangement* next = finished_scope(); next != nullptr; next = finished_scope())
            commit(*next, passed);
        return {first, next_};
    }

private:
    LocalArrangement* finished_scope() const {
        return next_ < finished_.size() ? finished_[next_].load(std::memory_order_acquire)
                                        : nullptr;
    }
    template <class Passed>
    void commit(LocalArrangement& scope, const Passed& passed) {
        scope.commit(geometry_);
        passed(next_);
        ++next_;
    }

    exact::PlanArrangement& geometry_;
    std::vector<std::atomic<LocalArrangement*>> finished_;
    std::mutex busy_;
    std::size_t next_ = 0;  ///< chunk to be committed; with busy_
};

}  // namespace realmodel::strata
