// SPDX-License-Identifier: GPL-3.0-or-later
// What examination.hpp does in a process of its own. Windows has no fork(): this is not compiled
// there.
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <stdexcept>

#include "examination.hpp"

namespace realmodel::fuzz {

namespace {

/// In the child: it is ended by a signal when it has used so much of processors.
void limit_processor_time(double seconds) {
    const auto whole = static_cast<rlim_t>(std::ceil(seconds));
    const rlimit limit{whole, whole + 1};
    setrlimit(RLIMIT_CPU, &limit);
}

/// In the child: kinds and sentences, each ended by a zero byte.
[[noreturn]] void tell(int pipe, const std::vector<Defect>& defects) {
    std::string text;
    for (const Defect& defect : defects)
        text += defect.kind + '\0' + defect.sentence + '\0';
    text += '\1';
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t now = write(pipe, text.data() + sent, text.size() - sent);
        if (now <= 0) _exit(3);
        sent += static_cast<std::size_t>(now);
    }
    _exit(0);
}

}  // namespace

std::vector<Defect> in_a_process(const std::function<std::vector<Defect>()>& work, double seconds) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
        close(ends[0]);
        limit_processor_time(seconds);
        tell(ends[1], work());
    }
    close(ends[1]);
    std::string text;
    char piece[4096];
    pollfd waiting{ends[0], POLLIN, 0};
    // A busy machine gives a process little of its time; threads that wait for each other use none.
    constexpr double kBusy = 10;
    bool in_time = true;
    while ((in_time = poll(&waiting, 1, static_cast<int>(1000 * kBusy * seconds)) > 0)) {
        const ssize_t got = read(ends[0], piece, sizeof piece);
        if (got <= 0) break;
        text.append(piece, static_cast<std::size_t>(got));
    }
    close(ends[0]);
    if (!in_time) kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    in_time = in_time && !(WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
    if (!in_time) return {{"hang", "no answer in time"}};
    if (text.empty() || text.back() != '\1') {
        const std::string how = WIFSIGNALED(status)
                                    ? "signal " + std::to_string(WTERMSIG(status))
                                    : "exit status " + std::to_string(WEXITSTATUS(status));
        return {{"crash", how}};
    }
    std::vector<Defect> defects;
    for (std::size_t at = 0; at + 1 < text.size();) {
        const std::size_t kind_end = text.find('\0', at), end = text.find('\0', kind_end + 1);
        defects.push_back(
            {text.substr(at, kind_end - at), text.substr(kind_end + 1, end - kind_end - 1)});
        at = end + 1;
    }
    return defects;
}

std::vector<Defect> examine_apart(const StackCase& stack, const JudgeOptions& options,
                                  double seconds) {
    return in_a_process([&] { return examine(stack, options).defects; }, seconds);
}

}  // namespace realmodel::fuzz
