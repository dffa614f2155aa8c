// SPDX-License-Identifier: GPL-3.0-or-later
#if defined(_WIN64)

#include <windows.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <vector>

#include "base/large_arrays.hpp"

namespace realmodel::page_store {

namespace {

/// Addresses for all large arrays, reserved at once: nothing but numbers until pages are committed.
/// Pages cannot be moved here, so an array gets the addresses at which most pages are kept.
class Arena {
public:
    static constexpr std::size_t kNone = SIZE_MAX;

    Arena() {
        std::size_t bytes = std::size_t{1} << 41;
        constexpr std::size_t kLeast = std::size_t{1} << 34;
        while (begin_ == nullptr && bytes >= kLeast) {
            bytes /= 2;
            begin_ = static_cast<char*>(VirtualAlloc(nullptr, bytes, MEM_RESERVE, PAGE_READWRITE));
        }
        if (begin_ == nullptr) throw std::bad_alloc();
        state_.resize(bytes / kPages);
        free_.emplace(0, state_.size());
    }

    char* address(std::size_t block) const { return begin_ + block * kPages; }
    std::size_t block(const char* address) const {
        return static_cast<std::size_t>(address - begin_) / kPages;
    }
    std::size_t kept() const { return kept_; }

    /// Addresses of so many blocks that no array has.
    /// @return the first block, or kNone
    std::size_t take(std::size_t count) {
        auto best = free_.end();
        std::size_t most = 0;
        for (auto range = free_.begin(); range != free_.end(); ++range) {
            if (range->second < count) continue;
            const auto from = state_.begin() + static_cast<std::ptrdiff_t>(range->first);
            const auto kept = static_cast<std::size_t>(
                std::count(from, from + static_cast<std::ptrdiff_t>(count), State::kKept));
            if (best != free_.end() && kept <= most) continue;
            best = range;
            most = kept;
        }
        if (best == free_.end()) return kNone;
        const auto [first, size] = *best;
        if (size > count) free_.emplace(first + count, size - count);
        free_.erase(best);
        return first;
    }

    /// The next blocks after an array of so many, where they are free.
    bool extend(std::size_t first, std::size_t count, std::size_t more) {
        const auto next = free_.find(first + count);
        if (next == free_.end() || next->second < more) return false;
        const std::size_t left = next->second - more;
        if (left > 0) free_.emplace(next->first + more, left);
        free_.erase(next);
        return true;
    }

    /// Addresses that an array does not need any more.
    void give_back(std::size_t first, std::size_t count) {
        if (count == 0) return;
        const auto own = free_.emplace(first, count).first;
        if (const auto next = std::next(own); next != free_.end()) join(own, next);
        if (own != free_.begin()) join(std::prev(own), own);
    }

    /// Gives blocks their pages. As many kept ones are given up as are needed to hold no more than
    /// a quarter beside what arrays had at most at once.
    /// @return false where the system has no memory for them; none is then used
    bool use(std::size_t first, std::size_t count) {
        std::size_t reused = 0;
        for (std::size_t at = first, end = first + count; at < end;) {
            const std::size_t begin = at;
            const State state = state_[at];
            while (at < end && state_[at] == state)
                ++at;
            if (state == State::kKept) {
                reused += at - begin;
            } else if (VirtualAlloc(address(begin), (at - begin) * kPages, MEM_COMMIT,
                                    PAGE_READWRITE) == nullptr) {
                for (std::size_t back = first; back < begin; ++back) {
                    if (state_[back] == State::kNothing) decommit(back, 1);
                }
                return false;
            }
        }
        const auto from = state_.begin() + static_cast<std::ptrdiff_t>(first);
        std::fill(from, from + static_cast<std::ptrdiff_t>(count), State::kUsed);
        kept_ -= reused;
        used_ += count;
        most_used_ = std::max(most_used_, used_);
        top_ = std::max(top_, first + count);
        const std::size_t most_held = most_used_ + most_used_ / 4;
        if (used_ + kept_ > most_held) give_up(used_ + kept_ - most_held);
        return true;
    }

    /// Keeps the pages of blocks, or not.
    void unuse(std::size_t first, std::size_t count, bool keeps) {
        const auto from = state_.begin() + static_cast<std::ptrdiff_t>(first);
        std::fill(from, from + static_cast<std::ptrdiff_t>(count),
                  keeps ? State::kKept : State::kNothing);
        used_ -= count;
        if (keeps) kept_ += count;
        if (!keeps && count > 0) decommit(first, count);
    }

    void give_up_all() {
        give_up(kept_);
        most_used_ = used_;
    }

private:
    enum class State : unsigned char { kNothing, kUsed, kKept };  // of the pages of a block
    using Ranges = std::map<std::size_t, std::size_t>;            // the first block, how many

    void decommit(std::size_t first, std::size_t count) {
        VirtualFree(address(first), count * kPages, MEM_DECOMMIT);
    }

    /// So many of the kept ones, those at the highest addresses first.
    void give_up(std::size_t count) {
        kept_ -= count;
        for (std::size_t end = top_; count > 0;) {
            while (state_[end - 1] != State::kKept)
                --end;
            std::size_t begin = end;
            while (begin > 0 && count > 0 && state_[begin - 1] == State::kKept) {
                state_[--begin] = State::kNothing;
                --count;
            }
            decommit(begin, end - begin);
            end = begin;
        }
        while (top_ > 0 && state_[top_ - 1] == State::kNothing)
            --top_;
    }

    /// Makes one range of two where they lie side by side.
    void join(Ranges::iterator low, Ranges::iterator high) {
        if (low->first + low->second != high->first) return;
        low->second += high->second;
        free_.erase(high);
    }

    char* begin_ = nullptr;
    std::vector<State> state_;
    Ranges free_;
    std::size_t used_ = 0, kept_ = 0, most_used_ = 0;  ///< blocks
    std::size_t top_ = 0;                              ///< above it no block has pages
};

struct Store {
    std::mutex busy;
    int keepers = 0;
    Arena arena;
};

/// Never destroyed: arrays may outlive everything else.
/// @throws std::bad_alloc where it is asked for the first time
Store& store() {
    static Store* const only = new Store;
    return *only;
}

}  // namespace

// Which blocks an array gets is decided where they are reserved.
bool take_kept(Memory&, std::size_t) {
    return false;
}

void reserve_blocks(Memory& memory, std::size_t bytes) {
    Store& all = store();
    const std::size_t count = bytes / kPages;
    Memory moved{nullptr, 0, bytes};
    {
        const std::lock_guard lock(all.busy);
        if (is_large(memory)) {
            const std::size_t before = memory.reserved / kPages;
            if (all.arena.extend(all.arena.block(memory.begin), before, count - before)) {
                memory.reserved = bytes;
                return;
            }
        }
        const std::size_t first = all.arena.take(count);
        if (first == Arena::kNone) throw std::bad_alloc();
        moved.begin = all.arena.address(first);
    }
    try {
        make_blocks_ready(moved, in_blocks(memory.ready));
    } catch (...) {
        drop_blocks(moved);
        throw;
    }
    if (memory.ready > 0) std::memcpy(moved.begin, memory.begin, memory.ready);
    drop(memory);
    memory = moved;
}

void make_blocks_ready(Memory& memory, std::size_t ready) {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    if (ready <= memory.ready) return;
    if (!all.arena.use(all.arena.block(memory.begin + memory.ready),
                       (ready - memory.ready) / kPages))
        throw std::bad_alloc();
    memory.ready = ready;
}

void drop_blocks(Memory& memory) noexcept {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    const std::size_t first = all.arena.block(memory.begin);
    all.arena.unuse(first, memory.ready / kPages, all.keepers > 0);
    try {
        all.arena.give_back(first, memory.reserved / kPages);
    } catch (const std::bad_alloc&) {  // these addresses are not used again
    }
}

std::size_t kept() noexcept {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    return all.arena.kept() * kPages;
}

Keeper::Keeper() {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    ++all.keepers;
}

Keeper::~Keeper() {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    if (--all.keepers == 0) all.arena.give_up_all();
}

}  // namespace realmodel::page_store

#endif
