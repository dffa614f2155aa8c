// SPDX-License-Identifier: GPL-3.0-or-later
// The entry that libFuzzer calls (scripts/fuzz.sh SECONDS --coverage): its bytes are the choices
// that stacks are made with, so that it looks for stacks that reach code which none reached before.
//
// REALMODEL_FUZZ_CORPUS names the folder of stacks to start from, REALMODEL_FUZZ_INTO the folder
// for findings.
#include <cstdio>
#include <cstdlib>

#include "case_file.hpp"
#include "examination.hpp"
#include "mutate.hpp"

namespace {

using namespace realmodel::fuzz;

const char* folder(const char* variable, const char* otherwise) {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : otherwise;
}

const std::vector<StackCase>& corpus() {
    static const std::vector<StackCase> stacks = [] {
        std::vector<StackCase> read;
        for (const auto& file : case_files(folder("REALMODEL_FUZZ_CORPUS", "")))
            read.push_back(read_case(file));
        return read;
    }();
    return stacks;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    RandomSource random(std::span<const std::uint8_t>(data, size));
    StackCase stack = make_case(random, corpus());
    if (triangle_count(stack) > 400) return -1;  // slow, and no more telling
    const Examination found = examine(std::move(stack), {100, 300, {}});
    if (found.defects.empty()) return found.usable ? 0 : -1;
    const std::string kind = least_kind(found.defects);
    const auto file = std::filesystem::path(folder("REALMODEL_FUZZ_INTO", ".")) /
                      ("coverage_" +
                       std::to_string(std::hash<std::string_view>()(
                           std::string_view(reinterpret_cast<const char*>(data), size))) +
                       ".json");
    write_case(found.stack, file, kind + ": " + found.defects[0].sentence);
    std::fprintf(stderr, "%s: %s\n", file.c_str(), kind.c_str());
    std::abort();
}
