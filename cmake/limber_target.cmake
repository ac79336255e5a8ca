# Options and the two functions every folder uses.
#
#   limber_library(NAME SOURCES... [LINK targets...] [EIGEN])   static library limber_NAME
#   limber_program(NAME SOURCES... [LINK targets...] [EIGEN])   program limber-NAME, into ${CMAKE_BINARY_DIR}/bin
#   limber_test(NAME SOURCES... [LINK targets...] [EIGEN])      GoogleTest program, registered with ctest
#
# EIGEN: with precompiled Eigen headers, which are half of the time such a file takes to compile.

option(LIMBER_BUILD_TESTS "Build the tests" ON)
option(LIMBER_BUILD_BENCH "Build the benchmarks" OFF)
option(LIMBER_WERROR "Treat warnings as errors" OFF)
set(LIMBER_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
find_program(LIMBER_CCACHE ccache)
if(LIMBER_CCACHE)
  # What ccache asks for with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${LIMBER_CCACHE})
  add_compile_options(-fpch-preprocess)
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

# Owns the precompiled headers that all targets with EIGEN share.
function(limber_precompiled name)
  file(WRITE ${CMAKE_BINARY_DIR}/generated/${name}.cc "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cc)
  target_link_libraries(${name} PRIVATE limber_flags ${ARGN})
  target_precompile_headers(${name} PRIVATE
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <memory> <string> <vector>)
endfunction()
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
limber_precompiled(limber_eigen_headers Eigen3::Eigen)
if(LIMBER_BUILD_TESTS)
  find_package(GTest REQUIRED)
  limber_precompiled(limber_test_headers Eigen3::Eigen GTest::gtest)
  target_precompile_headers(limber_test_headers PRIVATE <gtest/gtest.h>)
endif()

function(limber_library name)
  cmake_parse_arguments(arg "EIGEN" "" "LINK" ${ARGN})
  add_library(limber_${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber_${name} PUBLIC limber_flags ${arg_LINK})
  if(arg_EIGEN)
    target_precompile_headers(limber_${name} REUSE_FROM limber_eigen_headers)
  endif()
endfunction()

function(limber_program name)
  cmake_parse_arguments(arg "EIGEN" "" "LINK" ${ARGN})
  add_executable(limber-${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(limber-${name} PRIVATE limber_flags ${arg_LINK})
  if(arg_EIGEN)
    target_precompile_headers(limber-${name} REUSE_FROM limber_eigen_headers)
  endif()
  set_target_properties(limber-${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

function(limber_test name)
  cmake_parse_arguments(arg "EIGEN" "" "LINK" ${ARGN})
  add_executable(test_${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(test_${name} PRIVATE limber_flags ${arg_LINK} GTest::gtest GTest::gtest_main)
  if(arg_EIGEN)
    target_precompile_headers(test_${name} REUSE_FROM limber_test_headers)
  endif()
  target_compile_definitions(test_${name} PRIVATE LIMBER_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  set_target_properties(test_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${name} COMMAND test_${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT 300)
endfunction()
