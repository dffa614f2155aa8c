// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/page_store.hpp"

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>

#include "realmodel/base/memory.hpp"

namespace realmodel::page_store {

namespace {

bool is_large(const Memory& memory) {
    return memory.reserved >= kLargeArray;
}

/// How many bytes large arrays have that are ready, and what was dropped and is kept.
class Store {
public:
    /// The least that is enough, or else the largest.
    Memory take(std::size_t bytes) {
        const std::lock_guard lock(busy_);
        if (kept_.empty()) return {};
        auto found = kept_.lower_bound(bytes);
        if (found == kept_.end()) --found;
        const auto [size, begin] = *found;
        kept_.erase(found);
        kept_bytes_ -= size;
        return {static_cast<char*>(begin), size, size};
    }
    /// Arrays get more. No more is held than they had at most at once.
    void add(std::size_t bytes) {
        const std::lock_guard lock(busy_);
        used_ += bytes;
        most_used_ = std::max(most_used_, used_);
        give_up(most_used_ - used_);
    }
    /// Keeps what was ready of an array, or gives it back.
    void drop(const Memory& memory) noexcept {
        const std::lock_guard lock(busy_);
        used_ -= memory.ready;
        void* begin = memory.begin;
        if (keepers_ > 0 && memory.ready >= kLargeArray) {
            if (void* const less = std::realloc(begin, memory.ready)) begin = less;
            try {
                kept_.emplace(memory.ready, begin);
                kept_bytes_ += memory.ready;
                return;
            } catch (const std::bad_alloc&) {  // for its entry
            }
        }
        std::free(begin);
    }
    std::size_t kept() {
        const std::lock_guard lock(busy_);
        return kept_bytes_;
    }
    void give_back() {
        const std::lock_guard lock(busy_);
        give_up(0);
    }
    void add_keeper() {
        const std::lock_guard lock(busy_);
        if (++keepers_ == 1) most_used_ = used_;
    }
    void remove_keeper() {
        const std::lock_guard lock(busy_);
        if (--keepers_ == 0) give_up(0);
    }

private:
    /// The smallest first.
    void give_up(std::size_t most) {
        while (kept_bytes_ > most) {
            const auto first = kept_.begin();
            std::free(first->second);
            kept_bytes_ -= first->first;
            kept_.erase(first);
        }
    }

    std::mutex busy_;
    int keepers_ = 0;
    std::size_t used_ = 0, most_used_ = 0, kept_bytes_ = 0;
    std::multimap<std::size_t, void*> kept_;  ///< by their bytes
};

/// Never destroyed: arrays may outlive everything else.
Store& store() {
    static Store* const only = new Store;
    return *only;
}

}  // namespace

void reserve(Memory& memory, std::size_t bytes) {
    if (bytes <= memory.reserved) return;
    const bool was_large = is_large(memory), is_new = memory.begin == nullptr;
    Memory from = is_new && bytes >= kLargeArray ? store().take(bytes) : memory;
    char* const begin = static_cast<char*>(std::realloc(from.begin, bytes));
    if (begin == nullptr) {
        if (is_new) std::free(from.begin);
        throw std::bad_alloc();
    }
    memory = {begin, bytes, bytes};
    if (!is_large(memory)) return;
    memory.ready = std::min(from.ready, bytes);
    if (!was_large) store().add(memory.ready);
}

void make_ready(Memory& memory, std::size_t bytes) {
    constexpr std::size_t kLeast = 64;
    if (bytes > memory.reserved) reserve(memory, std::max({bytes, memory.reserved * 2, kLeast}));
    if (bytes <= memory.ready) return;
    const std::size_t before = memory.ready;
    memory.ready = std::min(std::max(bytes, before + before / 16), memory.reserved);
    store().add(memory.ready - before);
    assert(bytes <= memory.ready && memory.ready <= memory.reserved);
}

void drop(Memory& memory) noexcept {
    if (is_large(memory)) {
        store().drop(memory);
    } else {
        std::free(memory.begin);
    }
    memory = {};
}

std::size_t kept() noexcept {
    return store().kept();
}

Keeper::Keeper() {
    store().add_keeper();
}

Keeper::~Keeper() {
    store().remove_keeper();
}

}  // namespace realmodel::page_store

void realmodel::give_back_memory() noexcept {
    page_store::store().give_back();
#ifdef __GLIBC__
    malloc_trim(0);
#elif defined(_WIN32)
    _heapmin();
#endif
}
