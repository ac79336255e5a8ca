# Options and the functions every folder uses.
#
#   limber_sources(RESULT [ONLY folder] [EXCEPT ...])   the sources of a folder
#   limber_list(SOURCES)                          files that only list what there is
#   limber_library(NAME SOURCES... [LINK targets...])   static library limber_NAME
#   limber_program(NAME SOURCES... [LINK targets...] [INSTALLED])   program limber-NAME, into ${CMAKE_BINARY_DIR}/bin; INSTALLED: see
#                                                 limber_install.cmake
#   limber_tests(NAME [EXCEPT ...] [LINK targets...] [SHARDS n] [PLAIN])   GoogleTest program of all test_*.cc below, registered with
#                                                 ctest, and part of the target unit_tests. PLAIN: full of Eigen; under sanitizers, which
#                                                 triple its build, only with LIMBER_SANITIZE_ALL. Else it is part of plain_tests
#
# What takes time is Eigen: its headers, which are precompiled once for all, and its templates, which every translation unit
# instantiates anew. So files are compiled LIMBER_UNITY at a time as one. Two of them may then not have helpers of one name in
# their anonymous namespaces; a test file has a namespace of its own. LIMBER_UNITY=0 compiles each by itself: finds missing includes, and builds faster after small edits.

set(tests ON)
if(SKBUILD)  # pip builds a package
  set(tests OFF)
endif()
option(LIMBER_BUILD_TESTS "Build the tests" ${tests})
option(LIMBER_BUILD_BENCH "Build the benchmarks" OFF)
option(LIMBER_WERROR "Treat warnings as errors" OFF)
set(LIMBER_UNITY 16 CACHE STRING "Source files compiled as one; 0: each by itself")
set(LIMBER_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")
# For sources with rows of joints, which are wider than what other processors pass in a register (psabi) and never leave these files.
set(LIMBER_ROW_OPTIONS -Wno-psabi)
if(LIMBER_SANITIZE MATCHES address)
  # Each number that an inlined line passes on would be watched by itself: minutes a file instead of seconds.
  list(APPEND LIMBER_ROW_OPTIONS -fno-sanitize-address-use-after-scope -fno-sanitize=null,alignment,object-size)
endif()
option(LIMBER_SANITIZE_ALL "Sanitizers also for the tests that are full of Eigen" OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
find_program(LIMBER_CCACHE ccache)
if(LIMBER_CCACHE)
  # What ccache needs with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${LIMBER_CCACHE})
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  add_compile_options("$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()

if(LIMBER_UNITY)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE ${LIMBER_UNITY})
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

add_library(limber_flags INTERFACE)
target_include_directories(limber_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
# No -march=native: the distribution's KDL and Eigen would disagree about alignment across the library boundary.
# No fused multiply-add: the same scenario gives the same bytes with every compiler and processor.
target_compile_options(limber_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  target_compile_options(limber_flags INTERFACE -U__ARM_FEATURE_FMA)  # Eigen's own
endif()
# The same objects make programs here and liblimber.so, which shows nothing but LIMBER_PUBLIC (common/public.h).
target_compile_options(limber_flags INTERFACE -fPIC -fvisibility=hidden -fvisibility-inlines-hidden -fno-semantic-interposition)
if(LIMBER_WERROR)
  target_compile_options(limber_flags INTERFACE -Werror)
endif()
if(LIMBER_SANITIZE)
  target_compile_options(limber_flags INTERFACE -fsanitize=${LIMBER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(limber_flags INTERFACE -fsanitize=${LIMBER_SANITIZE})
  if(LIMBER_SANITIZE MATCHES "undefined")
    # In Eigen's templates these are most of the checks and of the compiler's time; a null pointer shows under ASan anyway.
    target_compile_options(limber_flags INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

# Precompiled headers that all targets share, and those that all tests share.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
target_link_libraries(limber_flags INTERFACE Eigen3::Eigen fmt::fmt)
function(limber_precompiled name)
  file(WRITE ${CMAKE_BINARY_DIR}/generated/${name}.cc "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cc)
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  target_link_libraries(${name} PRIVATE limber_flags ${ARGN})
  target_precompile_headers(${name} PRIVATE
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <fmt/format.h>
    <algorithm> <array> <cmath> <functional> <map> <memory> <optional> <span> <string> <variant> <vector>
    ${CMAKE_SOURCE_DIR}/common/eigen_templates.h)
endfunction()
limber_precompiled(limber_headers)
if(LIMBER_BUILD_TESTS)
  find_package(GTest REQUIRED)
  limber_precompiled(limber_test_headers GTest::gtest)
  target_precompile_headers(limber_test_headers PRIVATE <gtest/gtest.h>)
endif()

# All sources of this folder and the ones below: of ONLY these, or of all EXCEPT these (files, or folders with a `/`).
function(limber_sources result)
  cmake_parse_arguments(arg "" "" "ONLY;EXCEPT" ${ARGN})
  file(GLOB_RECURSE found CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  foreach(part IN LISTS arg_EXCEPT)
    list(FILTER found EXCLUDE REGEX "^${part}")
  endforeach()
  if(arg_ONLY)
    list(FILTER found INCLUDE REGEX "^${arg_ONLY}")
  endif()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# A file that lists what there is of a kind, and nothing else, in an object file of its own: a test may link another list.
function(limber_list)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(limber_library name)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_library(limber_${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber_${name} PUBLIC limber_flags ${arg_LINK})
  target_precompile_headers(limber_${name} REUSE_FROM limber_headers)
endfunction()

function(limber_program name)
  cmake_parse_arguments(arg "INSTALLED" "" "LINK" ${ARGN})
  add_executable(limber-${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber-${name} PRIVATE limber_flags ${arg_LINK})
  target_precompile_headers(limber-${name} REUSE_FROM limber_headers)
  set_target_properties(limber-${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  if(arg_INSTALLED)
    set_target_properties(limber-${name} PROPERTIES ENABLE_EXPORTS ON)  # for laws from shared libraries
    limber_installed(${name} ${arg_UNPARSED_ARGUMENTS} LINK ${arg_LINK})
  endif()
endfunction()

add_custom_target(unit_tests)
add_custom_target(plain_tests)
# All test_*.cc of this folder and the ones below in one program; run as several, side by side, if SHARDS is given.
function(limber_tests name)
  cmake_parse_arguments(arg "PLAIN" "SHARDS" "EXCEPT;LINK" ${ARGN})
  if(arg_PLAIN AND LIMBER_SANITIZE AND NOT LIMBER_SANITIZE_ALL)
    return()
  endif()
  limber_sources(sources EXCEPT ${arg_EXCEPT})
  list(FILTER sources INCLUDE REGEX "(^|/)test_[^/]*$")
  add_executable(test_${name} ${sources})
  add_dependencies(unit_tests test_${name})
  if(arg_PLAIN)
    add_dependencies(plain_tests test_${name})
  endif()
  target_link_libraries(test_${name} PRIVATE limber_flags ${arg_LINK} limber_source_path GTest::gtest GTest::gtest_main)
  target_precompile_headers(test_${name} REUSE_FROM limber_test_headers)
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 6)
  set_target_properties(test_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT arg_SHARDS)
    set(arg_SHARDS 1)
  endif()
  math(EXPR last "${arg_SHARDS} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME ${name}_${shard} COMMAND test_${name})
    set_tests_properties(${name}_${shard} PROPERTIES
      TIMEOUT 900 ENVIRONMENT "GTEST_TOTAL_SHARDS=${arg_SHARDS};GTEST_SHARD_INDEX=${shard}"
      LABELS $<IF:$<BOOL:${arg_PLAIN}>,plain,unit>)
  endforeach()
endfunction()
