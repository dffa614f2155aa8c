// SPDX-License-Identifier: GPL-3.0-or-later
// The backend of NVIDIA's GPUs. Compiled without fused multiply-add, and with square roots and
// divisions that are rounded correctly: the same bytes as the CPU's.
#include <chrono>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <stdexcept>

#include "offload.hpp"

namespace realmodel::cuda {

namespace {

void check(cudaError_t error) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // so that it is not met again, where it can be left behind
    if (error == cudaErrorMemoryAllocation) throw OutOfDeviceMemory();
    throw std::runtime_error(std::string("CUDA: ") + cudaGetErrorString(error));
}

/// The threads of a block.
struct ThreadsOfBlock {
    std::size_t thread, threads;
    __device__ void sync() const { __syncthreads(); }
};

template <class Function>
__global__ void run_each(std::size_t count, Function function) {
    const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
    if (i < count) function(i);
}

template <class Function>
__global__ void run_blocks(Function function) {
    extern __shared__ double memory[];
    function(ThreadsOfBlock{threadIdx.x, blockDim.x}, blockIdx.x, memory);
}

class CudaBackend {
public:
    template <class Element>
    class Array {
    public:
        Array(CudaBackend&, std::size_t size) : size_(size) {
            if (size > 0) check(cudaMalloc(&elements_, size * sizeof(Element)));
        }
        ~Array() { cudaFree(elements_); }
        Array(const Array&) = delete;
        Array& operator=(const Array&) = delete;
        Element* data() { return elements_; }
        std::size_t size() const { return size_; }

    private:
        Element* elements_ = nullptr;
        std::size_t size_;
    };

    template <class Element>
    void upload(Array<Element>& to, const Element* from) {
        transfer(to.data(), from, to.size() * sizeof(Element), cudaMemcpyHostToDevice);
    }
    template <class Element>
    void download(Element* to, Array<Element>& from) {
        transfer(to, from.data(), from.size() * sizeof(Element), cudaMemcpyDeviceToHost);
    }
    template <class Function>
    void each(std::size_t count, const Function& function) {
        if (count == 0) return;
        constexpr unsigned kThreads = 256;
        run_each<<<static_cast<unsigned>((count + kThreads - 1) / kThreads), kThreads>>>(count,
                                                                                         function);
        check(cudaGetLastError());
    }
    template <class Function>
    void each_block(std::size_t count, std::size_t threads, std::size_t numbers,
                    const Function& function) {
        if (count == 0) return;
        run_blocks<<<static_cast<unsigned>(count), static_cast<unsigned>(threads),
                     numbers * sizeof(double)>>>(function);
        check(cudaGetLastError());
    }
    void sort(Array<std::uint64_t>& keys, Array<std::int32_t>& values) {
        const int count = static_cast<int>(keys.size());
        Array<std::uint64_t> other_keys(*this, keys.size());
        Array<std::int32_t> other_values(*this, values.size());
        cub::DoubleBuffer<std::uint64_t> key_buffers(keys.data(), other_keys.data());
        cub::DoubleBuffer<std::int32_t> value_buffers(values.data(), other_values.data());
        with_room([&](void* room, std::size_t& bytes) {
            return cub::DeviceRadixSort::SortPairs(room, bytes, key_buffers, value_buffers, count);
        });
        if (value_buffers.Current() != values.data()) {
            check(cudaMemcpy(values.data(), value_buffers.Current(),
                             values.size() * sizeof(std::int32_t), cudaMemcpyDeviceToDevice));
        }
    }
    void add_up(Array<std::int32_t>& numbers) {
        with_room([&](void* room, std::size_t& bytes) {
            return cub::DeviceScan::InclusiveSum(room, bytes, numbers.data(), numbers.data(),
                                                 static_cast<int>(numbers.size()));
        });
    }
    double transfer_seconds() const { return transfer_seconds_; }

private:
    void transfer(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
        check(cudaDeviceSynchronize());  // what was begun before is no part of it
        const auto begin = std::chrono::steady_clock::now();
        check(cudaMemcpy(to, from, bytes, kind));
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        transfer_seconds_ += taken.count();
    }
    /// CUB says first how much it needs.
    template <class Call>
    void with_room(const Call& call) {
        std::size_t bytes = 0;
        check(call(nullptr, bytes));
        Array<char> room(*this, std::max<std::size_t>(bytes, 1));
        check(call(room.data(), bytes));
    }

    double transfer_seconds_ = 0;
};

}  // namespace

std::unique_ptr<OpenedDevice> open_device() {
    int devices = 0;
    const cudaError_t error = cudaGetDeviceCount(&devices);
    if (error == cudaErrorInsufficientDriver)
        throw std::runtime_error("there is no driver of NVIDIA, or one that is too old");
    if (error == cudaErrorNoDevice || devices == 0)
        throw std::runtime_error("there is no GPU of NVIDIA");
    check(error);
    cudaDeviceProp properties{};
    check(cudaGetDeviceProperties(&properties, 0));
    check(cudaFree(nullptr));  // begins its context, which takes part of a second
    return std::make_unique<Offload<CudaBackend>>(properties.name, std::make_unique<CudaBackend>());
}

}  // namespace realmodel::cuda
