// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/page_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace realmodel::page_store {

#if defined(__linux__)

namespace {

char* advanced(void* place, std::size_t bytes) {
    return static_cast<char*>(place) + bytes;
}

void unmap(void* place, std::size_t bytes) noexcept {
    if (bytes > 0) munmap(place, bytes);
}

/// Untouched pages, at a place if one is given: there nothing may be, or what lies there goes.
/// @return nullptr where the system has none
void* map(void* place, std::size_t bytes) noexcept {
    const int fixed = place != nullptr ? MAP_FIXED : 0;
    void* mapped = mmap(place, bytes, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | fixed, -1, 0);
    return mapped == MAP_FAILED ? nullptr : mapped;
}

/// Moves the pages of one block to another that was reserved. One block at a time, since pages
/// that came from several places can be moved together by the newest systems only.
bool move_block(void* from, void* to) noexcept {
    if (mremap(from, kBlock, kBlock, MREMAP_MAYMOVE | MREMAP_FIXED, to) == to) return true;
    // It may have gone after it had made room.
    if (map(to, kBlock) == nullptr) std::abort();
    return false;
}

/// Ranges of kept blocks by their addresses.
class KeptBlocks {
public:
    /// One of them that is wanted, or nullptr.
    char* take(std::size_t bytes) {
        auto best = ranges_.end();
        for (auto range = ranges_.begin(); range != ranges_.end(); ++range) {
            if (range->second < bytes) continue;
            if (best == ranges_.end() || range->second < best->second) best = range;
        }
        if (best == ranges_.end()) return nullptr;
        return take_end(best, bytes);
    }

    /// As large a part of `bytes` as one range has.
    std::pair<char*, std::size_t> take_some(std::size_t bytes) {
        if (char* whole = take(bytes); whole != nullptr) return {whole, bytes};
        const auto largest =
            std::max_element(ranges_.begin(), ranges_.end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        if (largest == ranges_.end()) return {nullptr, 0};
        const std::size_t size = largest->second;
        return {take_end(largest, size), size};
    }

    void add(char* begin, std::size_t bytes) {
        if (bytes == 0) return;
        auto next = ranges_.lower_bound(begin);
        if (next != ranges_.begin()) {
            const auto last = std::prev(next);
            if (last->first + last->second == begin) {
                begin = last->first;
                bytes += last->second;
                ranges_.erase(last);
            }
        }
        if (next != ranges_.end() && begin + bytes == next->first) {
            bytes += next->second;
            ranges_.erase(next);
        }
        ranges_.emplace(begin, bytes);
    }

    void unmap_all() noexcept {
        for (const auto& [begin, bytes] : ranges_)
            unmap(begin, bytes);
        ranges_.clear();
    }

    std::size_t bytes() const {
        std::size_t sum = 0;
        for (const auto& [begin, bytes] : ranges_)
            sum += bytes;
        return sum;
    }

private:
    using Ranges = std::map<char*, std::size_t>;

    char* take_end(Ranges::iterator range, std::size_t bytes) {
        char* const begin = range->first + (range->second - bytes);
        range->second -= bytes;
        if (range->second == 0) ranges_.erase(range);
        return begin;
    }

    Ranges ranges_;
};

struct Store {
    std::mutex busy;
    int keepers = 0;
    KeptBlocks kept;
};

/// Never destroyed: arrays may outlive everything else.
Store& store() {
    static Store* const only = new Store;
    return *only;
}

}  // namespace

void* reserve(std::size_t bytes) {
    // Whole blocks move by one entry of the page table each.
    void* const mapped = map(nullptr, bytes + kBlock);
    if (mapped == nullptr) throw std::bad_alloc();
    const auto address = reinterpret_cast<std::uintptr_t>(mapped);
    const std::size_t before = in_blocks(address) - address;
    char* const begin = advanced(mapped, before);
    unmap(mapped, before);
    unmap(begin + bytes, kBlock - before);
    return begin;
}

void* take(std::size_t bytes) {
    {
        Store& all = store();
        const std::lock_guard lock(all.busy);
        if (char* whole = all.kept.take(bytes); whole != nullptr) return whole;
    }
    void* const begin = reserve(bytes);
    try {
        give_blocks(begin, bytes);
    } catch (...) {
        unmap(begin, bytes);
        throw;
    }
    return begin;
}

void give_blocks(void* place, std::size_t bytes) {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    for (std::size_t given = 0; given < bytes;) {
        const auto [range, size] = all.kept.take_some(bytes - given);
        if (size == 0) return;
        for (std::size_t at = 0; at < size; at += kBlock) {
            if (!move_block(range + at, advanced(place, given + at))) {
                all.kept.add(range + at, size - at);
                return;
            }
        }
        given += size;
    }
}

void move(void* from, std::size_t used, std::size_t reserved, void* to) noexcept {
    for (std::size_t at = 0; at < used; at += kBlock) {
        if (move_block(advanced(from, at), advanced(to, at))) continue;
        std::memcpy(advanced(to, at), advanced(from, at), kBlock);
        unmap(advanced(from, at), kBlock);
    }
    unmap(advanced(from, used), reserved - used);
}

void drop(void* array, std::size_t used, std::size_t reserved) noexcept {
    if (array == nullptr) return;
    Store& all = store();
    std::unique_lock lock(all.busy);
    if (all.keepers > 0) {
        unmap(advanced(array, used), reserved - used);
        try {
            all.kept.add(static_cast<char*>(array), used);
            return;
        } catch (const std::bad_alloc&) {
            reserved = used;
        }
    }
    lock.unlock();
    unmap(array, reserved);
}

std::size_t kept() noexcept {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    return all.kept.bytes();
}

Keeper::Keeper() {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    ++all.keepers;
}

Keeper::~Keeper() {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    if (--all.keepers == 0) all.kept.unmap_all();
}

#else

// No array is large there.
void* reserve(std::size_t) {
    throw std::bad_alloc();
}
void* take(std::size_t) {
    throw std::bad_alloc();
}
void give_blocks(void*, std::size_t) {}
void move(void*, std::size_t, std::size_t, void*) noexcept {}
void drop(void*, std::size_t, std::size_t) noexcept {}
std::size_t kept() noexcept {
    return 0;
}
Keeper::Keeper() = default;
Keeper::~Keeper() = default;

#endif

}  // namespace realmodel::page_store
