# SPDX-License-Identifier: GPL-3.0-or-later
# Everything static, out of the libraries that tools/portable builds; its toolchain file sets GRANITA_PORTABLE and
# GRANITA_PYTHONS ("tag=folder of headers" each).  Targets have the names of GranitaDependencies.cmake.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)

# granita_static(TARGET HEADER header LIBRARIES name... LINKS target...)
function(granita_static target)
  cmake_parse_arguments(ARG "" "HEADER" "LIBRARIES;LINKS" ${ARGN})
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  find_path(${target}_INCLUDE ${ARG_HEADER} REQUIRED)
  target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE})
  foreach(library IN LISTS ARG_LIBRARIES)
    find_library(${target}_${library} ${library} REQUIRED)
    target_link_libraries(${target} INTERFACE ${${target}_${library}})
  endforeach()
  target_link_libraries(${target} INTERFACE ${ARG_LINKS})
endfunction()

granita_static(PkgConfig::HWY HEADER hwy/highway.h LIBRARIES hwy)
granita_static(PkgConfig::EPOXY HEADER epoxy/egl.h LIBRARIES epoxy LINKS ${CMAKE_DL_LIBS})
granita_static(granita_osd HEADER opensubdiv/bfr/surface.h LIBRARIES osdCPU)
granita_static(granita_glm HEADER glm/glm.hpp)
target_link_libraries(granita_flags INTERFACE granita_glm)
granita_static(granita_fmt HEADER fmt/core.h)
granita_static(granita_imath HEADER Imath/half.h LIBRARIES Imath-3_1)
granita_static(embree HEADER embree3/rtcore.h
  LIBRARIES embree3 embree_sse42 embree_avx embree_avx2 tasking lexers simd sys math LINKS TBB::tbb)
granita_static(granita_oiio HEADER OpenImageIO/texture.h
  LIBRARIES OpenImageIO OpenImageIO_Util OpenEXR-3_1 OpenEXRCore-3_1 IlmThread-3_1 Iex-3_1 Imath-3_1
    tiff jpeg png16 webpdemux webp sharpyuv boost_thread z
  LINKS granita_imath granita_fmt Threads::Threads ${CMAKE_DL_LIBS} rt)
target_compile_definitions(granita_oiio INTERFACE OIIO_STATIC_DEFINE=1)
granita_static(granita_pybind11 HEADER pybind11/pybind11.h)

# Builds in two places are equal, and a report of a crash names lines.  ccache may make paths relative to the build.
file(RELATIVE_PATH source_from_build ${CMAKE_BINARY_DIR} ${CMAKE_SOURCE_DIR})
string(REGEX REPLACE "/+$" "" source_from_build "${source_from_build}")
target_compile_options(granita_flags INTERFACE -gline-tables-only
  -ffile-prefix-map=${GRANITA_PORTABLE_CACHE}/=portable/ -ffile-prefix-map=${CMAKE_SOURCE_DIR}/=
  -ffile-prefix-map=${source_from_build}/= -ffile-prefix-map=${CMAKE_BINARY_DIR}/=)
target_compile_definitions(granita_flags INTERFACE GRANITA_PORTABLE=1)
