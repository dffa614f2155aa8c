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
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

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
#ifdef __GLIBC__
    malloc_trim(0);
#elif defined(_WIN32)
    _heapmin();
#endif
}

}  // namespace realmodel
