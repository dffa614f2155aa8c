// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <new>
#include <numeric>
#include <vector>

namespace realmodel::cuda {

/// The device has too little memory.
struct OutOfDeviceMemory : std::bad_alloc {};

/// A block of threads that share the work of one system: here one thread.
struct SingleThread {
    std::size_t thread = 0, threads = 1;
    void sync() const {}
};

/// What the algorithms need of a device (CudaBackend has the same members), in this process's
/// memory on one thread: for tests, and for what is left where a device has too little memory.
class CpuBackend {
public:
    /// @param memory  bytes that its arrays may take together
    explicit CpuBackend(std::size_t memory = std::numeric_limits<std::size_t>::max())
        : free_(memory) {}

    template <class Element>
    class Array {
    public:
        /// @throws OutOfDeviceMemory
        Array(CpuBackend& backend, std::size_t size)
            : backend_(backend), bytes_(size * sizeof(Element)) {
            if (bytes_ > backend.free_) throw OutOfDeviceMemory();
            elements_.resize(size);
            backend.free_ -= bytes_;
        }
        ~Array() { backend_.free_ += bytes_; }
        Array(const Array&) = delete;
        Array& operator=(const Array&) = delete;
        Element* data() { return elements_.data(); }
        std::size_t size() const { return elements_.size(); }

    private:
        CpuBackend& backend_;
        std::size_t bytes_;
        std::vector<Element> elements_;
    };

    template <class Element>
    void upload(Array<Element>& to, const Element* from) {
        std::copy_n(from, to.size(), to.data());
    }
    template <class Element>
    void download(Element* to, Array<Element>& from) {
        std::copy_n(from.data(), from.size(), to);
    }
    /// function(i) for each i < count, in any order.
    template <class Function>
    void each(std::size_t count, const Function& function) {
        for (std::size_t i = 0; i < count; ++i)
            function(i);
    }
    /// function(block, i, memory) for each i < count; all threads of a block call it, with memory
    /// that they share.
    template <class Function>
    void each_block(std::size_t count, std::size_t /*threads*/, std::size_t numbers,
                    const Function& function) {
        std::vector<double> memory(numbers);
        for (std::size_t i = 0; i < count; ++i)
            function(SingleThread{}, i, memory.data());
    }
    /// Sorts by the keys; values of equal keys keep their order.
    void sort(Array<std::uint64_t>& keys, Array<std::int32_t>& values) {
        std::vector<std::pair<std::uint64_t, std::int32_t>> pairs(keys.size());
        for (std::size_t i = 0; i < pairs.size(); ++i)
            pairs[i] = {keys.data()[i], values.data()[i]};
        std::ranges::stable_sort(pairs, {}, &std::pair<std::uint64_t, std::int32_t>::first);
        for (std::size_t i = 0; i < pairs.size(); ++i)
            values.data()[i] = pairs[i].second;
    }
    /// Makes of each number the sum up to it.
    void add_up(Array<std::int32_t>& numbers) {
        std::inclusive_scan(numbers.data(), numbers.data() + numbers.size(), numbers.data());
    }
    double transfer_seconds() const { return 0; }

private:
    std::size_t free_;
};

}  // namespace realmodel::cuda
