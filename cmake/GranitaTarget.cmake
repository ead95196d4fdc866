# SPDX-License-Identifier: GPL-3.0-or-later
# One static library a folder of native/, compiled with the same flags.
find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library(granita_flags INTERFACE)
target_compile_features(granita_flags INTERFACE cxx_std_20)
target_include_directories(granita_flags INTERFACE ${CMAKE_SOURCE_DIR}/native)
# -ffp-contract=off: a fused edge function is not antisymmetric, and tilings would leak (docs/decisions/hiding.md).
# x86-64-v2: what Blender 4 asks for too; wider units are taken at run time by Highway.
# No errno of roots and no traps: nothing reads them, and loops without branches become vectors; values stay.
target_compile_options(granita_flags INTERFACE -Wall -Wextra -Werror -march=x86-64-v2
  -ffp-contract=off -fno-math-errno -fno-trapping-math -fvisibility=hidden -fvisibility-inlines-hidden)
if(GRANITA_SANITIZE)
  # Calls of the sanitizer hide from the compiler what sets a variable.
  target_compile_options(granita_flags INTERFACE -fsanitize=${GRANITA_SANITIZE} -fno-omit-frame-pointer -g1
    -Wno-maybe-uninitialized)
  target_link_options(granita_flags INTERFACE -fsanitize=${GRANITA_SANITIZE})
endif()

# Most of a file's seconds go into headers that all of them share (docs/decisions/building.md).  Sanitizers and
# the portable build do without, and so find a file that leans on what it does not include; ccache would not keep any.
if(GRANITA_SANITIZE OR GRANITA_PORTABLE OR CCACHE)
  set(GRANITA_PRECOMPILED OFF)
else()
  set(GRANITA_PRECOMPILED ON)
endif()

# granita_precompiled(TARGET OWNER header...): the owner makes them, other targets take them from it.
function(granita_precompiled target owner)
  if(NOT GRANITA_PRECOMPILED)
    return()
  endif()
  if(target STREQUAL owner)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

# granita_target(NAME SOURCES file... LINKS target...)
function(granita_target name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  if(ARG_SOURCES)
    add_library(granita_${name} STATIC ${ARG_SOURCES})
    set_target_properties(granita_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(granita_${name} PUBLIC granita_flags ${ARG_LINKS})
    granita_precompiled(granita_${name} granita_base ${CMAKE_SOURCE_DIR}/cmake/precompiled.h)
  else()
    add_library(granita_${name} INTERFACE)
    target_link_libraries(granita_${name} INTERFACE granita_flags ${ARG_LINKS})
  endif()
endfunction()
