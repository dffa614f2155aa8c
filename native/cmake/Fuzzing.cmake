# SPDX-License-Identifier: GPL-3.0-or-later
# The fuzzers of the stack builder and of Booleans (native/fuzz): made inputs, judged by oracles of their own.

file(GLOB fuzzing_sources CONFIGURE_DEPENDS fuzz/*.cpp)
if(WIN32) # the fuzzers give every case a process of its own, by fork()
    list(FILTER fuzzing_sources EXCLUDE REGEX own_process)
endif()
add_library(realmodel_fuzzing STATIC ${fuzzing_sources})
build_by_folder(realmodel_fuzzing)
target_include_directories(realmodel_fuzzing PUBLIC fuzz PRIVATE src)
# Debian's property_tree includes a header that asks every reader to say so.
set_source_files_properties(fuzz/case_file.cpp PROPERTIES COMPILE_DEFINITIONS BOOST_BIND_GLOBAL_PLACEHOLDERS)
target_link_libraries(realmodel_fuzzing
    PUBLIC realmodel realmodel_settings
    PRIVATE realmodel_dependencies realmodel_warnings)

# Allocations that fail on request: the linker gives what calls malloc() and realloc() these instead.
add_library(realmodel_failing_allocations INTERFACE)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT REALMODEL_SANITIZE)
    target_sources(realmodel_failing_allocations INTERFACE
        "${CMAKE_CURRENT_SOURCE_DIR}/fuzz/allocations/failing_allocations.cpp")
    target_link_options(realmodel_failing_allocations INTERFACE -Wl,--wrap=malloc -Wl,--wrap=realloc)
endif()

set(fuzzing_programs build_digests)
if(NOT WIN32)
    list(APPEND fuzzing_programs stack_fuzzer boolean_fuzzer)
endif()
if(REALMODEL_SANITIZE MATCHES "fuzzer-no-link") # preset fuzz: clang++'s libFuzzer
    list(APPEND fuzzing_programs coverage_fuzzer)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT REALMODEL_SANITIZE)
    list(APPEND fuzzing_programs allocation_fuzzer)
endif()
foreach(program IN LISTS fuzzing_programs)
    add_executable(${program} fuzz/programs/${program}.cpp)
    target_link_libraries(${program} PRIVATE realmodel_fuzzing realmodel_warnings)
endforeach()
if(TARGET allocation_fuzzer)
    target_link_libraries(allocation_fuzzer PRIVATE realmodel_failing_allocations)
endif()
if(TARGET coverage_fuzzer)
    target_link_options(coverage_fuzzer PRIVATE -fsanitize=fuzzer)
endif()

if(WIN32)
    return()
endif()

# Every stack of the corpus, and a bounded number of made ones: the same on every run.
set(stacks "${PROJECT_SOURCE_DIR}/tests/data/stacks")
file(GLOB stack_files CONFIGURE_DEPENDS "${stacks}/*.json")
set(fuzz_cases 500)
if(REALMODEL_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(fuzz_cases 60) # ten times slower
endif()
set(fuzz_findings "${CMAKE_CURRENT_BINARY_DIR}/fuzz_findings")
add_test(NAME StackFuzzer.Corpus COMMAND stack_fuzzer --into ${fuzz_findings} ${stack_files})
add_test(NAME StackFuzzer.Cases
    COMMAND stack_fuzzer --cases ${fuzz_cases} --seed 1 --corpus ${stacks} --into ${fuzz_findings})
# The same of pairs of surfaces, whose judge takes longer.
math(EXPR pair_cases "${fuzz_cases} / 10")
set(pairs "${PROJECT_SOURCE_DIR}/tests/data/booleans")
file(GLOB pair_files CONFIGURE_DEPENDS "${pairs}/*.json")
if(REALMODEL_SANITIZE) # as long as all others together
    list(FILTER pair_files EXCLUDE REGEX "rounds_make_ever_more_pieces|sheets_farther_apart")
endif()
add_test(NAME BooleanFuzzer.Corpus COMMAND boolean_fuzzer --into ${fuzz_findings} ${pair_files})
add_test(NAME BooleanFuzzer.Cases
    COMMAND boolean_fuzzer --cases ${pair_cases} --seed 1 --corpus ${pairs} --into ${fuzz_findings})
set_tests_properties(StackFuzzer.Corpus StackFuzzer.Cases BooleanFuzzer.Corpus BooleanFuzzer.Cases PROPERTIES ${test_properties})
