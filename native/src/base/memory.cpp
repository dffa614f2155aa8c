// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/memory.hpp"

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif
#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#include <unistd.h>
#endif
#if defined(_WIN32)
#include <windows.h>
#endif

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>

#include "realmodel/base/page_store.hpp"

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
        if (caches_ > 0 && memory.ready >= kLargeArray) {
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
    void add_cache() {
        const std::lock_guard lock(busy_);
        if (++caches_ == 1) most_used_ = used_;
    }
    void remove_cache() {
        const std::lock_guard lock(busy_);
        if (--caches_ == 0) give_up(0);
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
    int caches_ = 0;
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

PageCache::PageCache() {
    store().add_cache();
}

PageCache::~PageCache() {
    store().remove_cache();
}

}  // namespace realmodel::page_store

namespace realmodel {

namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
    return limit > used ? limit - used : 0;
}

/// The number after a name in a file of lines "name number", e.g. /proc/meminfo.
std::optional<std::uint64_t> named_number(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    std::string word;
    while (file >> word) {
        std::uint64_t number = 0;
        if (word == name && file >> number) return number;
        file.clear();
        file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    return std::nullopt;
}

std::optional<std::uint64_t> only_number(const std::string& path) {
    std::ifstream file(path);
    std::uint64_t number = 0;
    if (file >> number) return number;  // "max" is no number: no limit
    return std::nullopt;
}

std::uint64_t left_by_machine() {
#if defined(_WIN32)
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    if (GlobalMemoryStatusEx(&status) == 0) return unlimited;
    // What is promised to processes must find room in memory or in the page file.
    return std::min({status.ullAvailPhys, status.ullAvailPageFile, status.ullAvailVirtual});
#else
    const auto kibibytes = named_number("/proc/meminfo", "MemAvailable:");
    return kibibytes ? *kibibytes * 1024 : unlimited;
#endif
}

/// What one control group leaves; page cache that can be dropped counts as free.
std::uint64_t left_by_group(const std::string& folder, const char* limit_name,
                            const char* usage_name, const char* cache_name) {
    const auto limit = only_number(folder + limit_name);
    const auto usage = only_number(folder + usage_name);
    if (!limit || !usage) return unlimited;
    const std::uint64_t cache = named_number(folder + "memory.stat", cache_name).value_or(0);
    return left_of(*limit, left_of(*usage, cache));
}

/// The least that the group of this process and the groups around it leave.
std::uint64_t left_by_groups() {
    std::uint64_t left = unlimited;
    std::ifstream groups("/proc/self/cgroup");  // lines "number:controllers:/path"
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':');
        const std::size_t second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        std::string path = line.substr(second + 1);
        const bool unified = controllers.empty();
        if (!unified && controllers.find("memory") == std::string::npos) continue;
        while (true) {
            if (path.empty() || path.back() != '/') path += '/';
            left = std::min(
                left, unified
                          ? left_by_group("/sys/fs/cgroup" + path, "memory.max", "memory.current",
                                          "inactive_file")
                          : left_by_group("/sys/fs/cgroup/memory" + path, "memory.limit_in_bytes",
                                          "memory.usage_in_bytes", "total_inactive_file"));
            if (path == "/") break;
            path.erase(path.find_last_of('/', path.size() - 2));
        }
    }
    return left;
}

std::uint64_t left_by_address_space() {
#ifdef RLIMIT_AS
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    const auto pages = only_number("/proc/self/statm");
    if (!pages) return unlimited;
    return left_of(limit.rlim_cur, *pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
#else
    return unlimited;
#endif
}

}  // namespace

std::uint64_t available_memory() {
    return std::min({left_by_machine(), left_by_groups(), left_by_address_space()});
}

void give_back_memory() noexcept {
    page_store::store().give_back();
#ifdef __GLIBC__
    malloc_trim(0);
#elif defined(_WIN32)
    _heapmin();
#endif
}

}  // namespace realmodel
