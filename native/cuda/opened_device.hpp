// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "realmodel/base/device.hpp"

namespace realmodel::cuda {

/// A device that is open: what Execution::device points to, and what it has to say.
class OpenedDevice {
public:
    virtual ~OpenedDevice() = default;
    OpenedDevice(const OpenedDevice&) = delete;
    OpenedDevice& operator=(const OpenedDevice&) = delete;

    const Device& device() const { return device_; }
    const std::string& name() const { return name_; }

    /// What was left to the CPU or done in tiles since the last call, each message once.
    std::vector<std::string> take_messages() {
        const std::lock_guard lock(mutex_);
        return std::exchange(messages_, {});
    }

    /// Seconds that copying to the device and back has taken so far.
    virtual double transfer_seconds() = 0;

protected:
    explicit OpenedDevice(std::string name) : name_(std::move(name)) {}
    void say(const std::string& message) {
        const std::lock_guard lock(mutex_);
        if (std::ranges::find(messages_, message) == messages_.end()) messages_.push_back(message);
    }
    Device device_{};

private:
    std::string name_;
    std::mutex mutex_;
    std::vector<std::string> messages_;
};

/// Opens the first GPU.
/// @throws std::runtime_error  why there is none: no driver, no device
std::unique_ptr<OpenedDevice> open_device();

}  // namespace realmodel::cuda
