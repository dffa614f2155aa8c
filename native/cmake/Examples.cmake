# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of what cmake --install leaves: it is installed into the build folder, native/examples/NAME is built with
# it by find_package, and run. Sanitized code would need its flags in the example too.

set(installed "${CMAKE_CURRENT_BINARY_DIR}/installed")
add_test(NAME Installed.Library
    COMMAND "${CMAKE_COMMAND}" --install "${PROJECT_BINARY_DIR}" --prefix "${installed}" --component realmodel)
set_tests_properties(Installed.Library PROPERTIES FIXTURES_SETUP installed_library)

function(add_example name output)
    add_test(NAME Installed.${name}
        COMMAND "${CMAKE_CTEST_COMMAND}"
            --build-and-test "${CMAKE_CURRENT_SOURCE_DIR}/examples/${name}" "${CMAKE_CURRENT_BINARY_DIR}/examples/${name}"
            --build-generator "${CMAKE_GENERATOR}" --build-makeprogram "${CMAKE_MAKE_PROGRAM}"
            --build-options
                "-DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}" "-DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}"
                "-DCMAKE_PREFIX_PATH=${installed}"
            --test-command ${name})
    set_tests_properties(Installed.${name} PROPERTIES
        FIXTURES_REQUIRED installed_library PASS_REGULAR_EXPRESSION "${output}")
endfunction()

add_example(two_layers "lower layer 148000\\.0\nupper layer 32000\\.0\n")
add_example(one_fault "lower layer 98000\\.0\nupper layer 97600\\.0\n")
