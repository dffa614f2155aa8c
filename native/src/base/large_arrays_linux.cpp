// SPDX-License-Identifier: GPL-3.0-or-later
#if defined(__linux__)

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <utility>

#include "base/large_arrays.hpp"

namespace realmodel::page_store {

namespace {

void unmap(char* begin, std::size_t bytes) noexcept {
    if (bytes > 0) munmap(begin, bytes);
}

/// Untouched pages, whole blocks: these move by one entry of the page table each.
/// @return nullptr where the system has none
char* map(std::size_t bytes) noexcept {
    void* const mapped = mmap(nullptr, bytes + kBlock, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (mapped == MAP_FAILED) return nullptr;
    const auto address = reinterpret_cast<std::uintptr_t>(mapped);
    const std::size_t before = in_blocks(address) - address;
    char* const begin = static_cast<char*>(mapped) + before;
    unmap(static_cast<char*>(mapped), before);
    unmap(begin + bytes, kBlock - before);
    return begin;
}

/// Moves the pages of one block to another one of ours, which is untouched. One block at a time,
/// since pages that came from several ranges can be moved together by the newest systems only.
/// Where it fails the system may have unmapped the target first, and another thread of the process
/// may have mapped something else there since: it is not ours any more, and nothing here reads,
/// writes, maps or unmaps it again.
bool move_block(char* from, char* to) noexcept {
    return mremap(from, kBlock, kBlock, MREMAP_MAYMOVE | MREMAP_FIXED, to) == to;
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
        const auto own = ranges_.emplace(begin, bytes).first;
        if (const auto next = std::next(own); next != ranges_.end()) join(own, next);
        if (own != ranges_.begin()) join(std::prev(own), own);
    }

    /// @return bytes that there were
    std::size_t unmap_all() noexcept {
        const std::size_t all = bytes();
        for (const auto& [begin, bytes] : ranges_)
            unmap(begin, bytes);
        ranges_.clear();
        return all;
    }

    std::size_t bytes() const {
        std::size_t sum = 0;
        for (const auto& [begin, bytes] : ranges_)
            sum += bytes;
        return sum;
    }

private:
    using Ranges = std::map<char*, std::size_t>;

    /// Makes one range of two where they lie side by side.
    void join(Ranges::iterator low, Ranges::iterator high) {
        if (low->first + low->second != high->first) return;
        low->second += high->second;
        ranges_.erase(high);
    }
    char* take_end(Ranges::iterator range, std::size_t bytes) {
        char* const begin = range->first + (range->second - bytes);
        range->second -= bytes;
        if (range->second == 0) ranges_.erase(range);
        return begin;
    }

    Ranges ranges_;
};

/// Each moved block may become a mapping of its own, of which a process has 65,530 (Linux,
/// vm.max_map_count): where more memory than this is held, blocks are neither kept nor moved.
constexpr std::size_t kMostHeld = 30000 * kBlock;

struct Store {
    std::mutex busy;
    int keepers = 0;
    KeptBlocks kept;
    std::atomic<std::size_t> held{0};  ///< bytes of large arrays that are ready, and kept ones
};

/// Never destroyed: arrays may outlive everything else.
Store& store() {
    static Store* const only = new Store;
    return *only;
}

/// Puts an array together again after a block could not be moved into `target`: what has arrived
/// before it there and what is left of `memory` are copied to fresh pages.
void copy_after_failure(Memory& memory, char* target, std::size_t arrived, std::size_t reserved) {
    char* const fresh = map(reserved);
    if (fresh != nullptr) {
        std::memcpy(fresh, target, arrived);
        if (memory.begin != target)
            std::memcpy(fresh + arrived, memory.begin + arrived, memory.ready - arrived);
    }
    unmap(target, arrived);
    unmap(target + arrived + kBlock, reserved - arrived - kBlock);
    if (memory.begin != target) unmap(memory.begin + arrived, memory.reserved - arrived);
    if (fresh == nullptr) {
        store().held -= memory.ready;
        memory = {};
        throw std::bad_alloc();
    }
    memory.begin = fresh;
    memory.reserved = reserved;
}

}  // namespace

void make_blocks_ready(Memory& memory, std::size_t ready) {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    while (memory.ready < ready && all.held < kMostHeld) {
        const auto [range, size] = all.kept.take_some(ready - memory.ready);
        if (size == 0) break;
        for (std::size_t at = 0; at < size; at += kBlock, memory.ready += kBlock) {
            if (move_block(range + at, memory.begin + memory.ready)) continue;
            unmap(range + at, size - at);
            all.held -= size - at + all.kept.unmap_all();
            copy_after_failure(memory, memory.begin, memory.ready, memory.reserved);
            break;
        }
    }
    all.held += ready - memory.ready;
    memory.ready = ready;
}

bool take_kept(Memory& memory, std::size_t bytes) {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    char* const begin = all.kept.take(bytes);
    if (begin != nullptr) memory = {begin, bytes, bytes};
    return begin != nullptr;
}

void reserve_blocks(Memory& memory, std::size_t bytes) {
    Memory moved{map(bytes), 0, bytes};
    if (moved.begin == nullptr) throw std::bad_alloc();
    if (is_large(memory) && store().held < kMostHeld) {
        for (std::size_t at = 0; at < memory.ready; at += kBlock) {
            if (move_block(memory.begin + at, moved.begin + at)) continue;
            copy_after_failure(memory, moved.begin, at, bytes);
            return;
        }
        unmap(memory.begin + memory.ready, memory.reserved - memory.ready);
        memory.begin = moved.begin;
        memory.reserved = bytes;
        return;
    }
    if (memory.ready > 0) {
        make_ready(moved, memory.ready);
        std::memcpy(moved.begin, memory.begin, memory.ready);
    }
    drop(memory);
    memory = moved;
}

void drop_blocks(Memory& memory) noexcept {
    Store& all = store();
    const std::lock_guard lock(all.busy);
    unmap(memory.begin + memory.ready, memory.reserved - memory.ready);
    if (all.keepers > 0 && all.held < kMostHeld) {
        try {
            all.kept.add(memory.begin, memory.ready);
            return;
        } catch (const std::bad_alloc&) {  // for its entry
        }
    }
    all.held -= memory.ready;
    unmap(memory.begin, memory.ready);
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
    if (--all.keepers == 0) all.held -= all.kept.unmap_all();
}

}  // namespace realmodel::page_store

#endif
