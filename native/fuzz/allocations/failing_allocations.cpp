// SPDX-License-Identifier: GPL-3.0-or-later
#include "failing_allocations.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

extern "C" {  // of the linker's option --wrap
void* __real_malloc(std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __wrap_malloc(std::size_t size);
void* __wrap_realloc(void* memory, std::size_t size);
}

namespace {

std::atomic<bool> is_on{false}, later_too{false};
std::atomic<std::uint64_t> failing{0}, asked{0};

bool fails() {
    if (!is_on.load()) return false;
    const std::uint64_t number = ++asked;
    return later_too.load() ? number >= failing.load() : number == failing.load();
}

void* taken(std::size_t size, std::size_t alignment) {
    void* const got =
        fails() ? nullptr
        : alignment > 0
            ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
            : __real_malloc(size > 0 ? size : 1);
    if (got == nullptr) throw std::bad_alloc();
    return got;
}

}  // namespace

void* __wrap_malloc(std::size_t size) {
    return fails() ? nullptr : __real_malloc(size);
}
void* __wrap_realloc(void* memory, std::size_t size) {
    return fails() ? nullptr : __real_realloc(memory, size);
}

// Those for arrays, and those that do not throw, call these.
void* operator new(std::size_t size) {
    return taken(size, 0);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return taken(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace realmodel::fuzz {

FailingAllocations::FailingAllocations(std::uint64_t number, bool and_later) {
    failing = number;
    later_too = and_later;
    asked = 0;
    is_on = true;
}

FailingAllocations::~FailingAllocations() {
    is_on = false;
}

std::uint64_t FailingAllocations::count() const {
    return asked;
}

}  // namespace realmodel::fuzz
