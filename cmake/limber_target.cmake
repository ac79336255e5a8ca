# Options and the two functions every folder uses.
#
#   limber_library(NAME SOURCES... [LINK targets...])   static library limber_NAME
#   limber_program(NAME SOURCES... [LINK targets...])   program limber-NAME, into ${CMAKE_BINARY_DIR}/bin
#   limber_test(NAME SOURCES... [LINK targets...])      GoogleTest program, registered with ctest

option(LIMBER_BUILD_TESTS "Build the tests" ON)
option(LIMBER_BUILD_BENCH "Build the benchmarks" OFF)
option(LIMBER_WERROR "Treat warnings as errors" OFF)
set(LIMBER_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
find_program(LIMBER_CCACHE ccache)
if(LIMBER_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${LIMBER_CCACHE})
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

add_library(limber_flags INTERFACE)
target_include_directories(limber_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
# No -march=native: the distribution's KDL and Eigen would disagree about alignment across the library boundary.
# No fused multiply-add contraction: the same scenario gives the same bytes with every compiler of one machine type.
target_compile_options(limber_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off)
if(LIMBER_WERROR)
  target_compile_options(limber_flags INTERFACE -Werror)
endif()
if(LIMBER_SANITIZE)
  target_compile_options(limber_flags INTERFACE -fsanitize=${LIMBER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(limber_flags INTERFACE -fsanitize=${LIMBER_SANITIZE})
endif()

function(limber_library name)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_library(limber_${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber_${name} PUBLIC limber_flags ${arg_LINK})
endfunction()

function(limber_program name)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_executable(limber-${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber-${name} PRIVATE limber_flags ${arg_LINK})
  set_target_properties(limber-${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

function(limber_test name)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_executable(test_${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(test_${name} PRIVATE limber_flags ${arg_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE LIMBER_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  set_target_properties(test_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${name} COMMAND test_${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT 300)
endfunction()
