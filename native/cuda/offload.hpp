// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "kriging.hpp"
#include "merging.hpp"
#include "opened_device.hpp"

namespace realmodel::cuda {

/// The functions of a Device by a backend. Where its memory is too little they compute tile by
/// tile, with the same bytes, and below the least tile they leave it to the caller; both is said in
/// a message.
template <class Backend>
class Offload final : public OpenedDevice {
public:
    /// @param least_tile  vertices or nodes
    Offload(std::string name, std::unique_ptr<Backend> backend, std::size_t least_tile = 1 << 10)
        : OpenedDevice(std::move(name)), backend_(std::move(backend)), least_tile_(least_tile) {
        device_ = {Device::kLayout, this,
                   [](void* state, const VertexMerging& task) {
                       return static_cast<Offload*>(state)->locked(
                           "merging vertices", [&](auto& of) { return of.merge(task); });
                   },
                   [](void* state, const KrigingSystems& systems) {
                       return static_cast<Offload*>(state)->locked(
                           "kriging", [&](auto& of) { return of.krige(systems); });
                   }};
    }

    double transfer_seconds() override { return backend_->transfer_seconds(); }

private:
    /// One computation at a time: each has all of the memory.
    template <class Compute>
    bool locked(const char* what, const Compute& compute) {
        const std::lock_guard lock(mutex_);
        const auto on_cpu = [&](const std::string& why) {
            say(std::string(what) + ": " + why + "; the CPU does it, with the same result");
            return false;
        };
        try {
            if (compute(*this)) return true;
        } catch (const OutOfDeviceMemory&) {
        } catch (const std::exception& error) {
            return on_cpu(error.what());
        }
        return on_cpu("the device has too little memory");
    }

    void say_tiles(const char* what, std::size_t tile) {
        say(std::string(what) + ": the device has too little memory for all at once; it took " +
            std::to_string(tile) + " at a time, with the same result");
    }

    bool merge(const VertexMerging& task) {
        const std::vector<std::int32_t> shared = shared_of(task);
        try {
            merge_at_once(*backend_, task, shared);
            return true;
        } catch (const OutOfDeviceMemory&) {
        }
        for (std::size_t tile = shared.size() / 2; tile >= least_tile_; tile /= 2) {
            try {
                merge_in_tiles(*backend_, task, shared, tile);
                say_tiles("merging vertices", tile);
                return true;
            } catch (const OutOfDeviceMemory&) {
            }
        }
        return false;
    }

    bool krige(const KrigingSystems& systems) {
        SystemsOnDevice<Backend> on_device(*backend_, systems);
        std::size_t tile = systems.node_count;
        for (std::size_t begin = 0; begin < systems.node_count;) {
            const std::size_t count = std::min(tile, systems.node_count - begin);
            try {
                on_device.krige(begin, count);
                begin += count;
            } catch (const OutOfDeviceMemory&) {
                tile /= 2;
                if (tile < least_tile_) return false;
            }
        }
        if (tile < systems.node_count) say_tiles("kriging", tile);
        return true;
    }

    std::mutex mutex_;
    std::unique_ptr<Backend> backend_;
    std::size_t least_tile_;
};

}  // namespace realmodel::cuda
