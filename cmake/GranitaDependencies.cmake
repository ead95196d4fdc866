# SPDX-License-Identifier: GPL-3.0-or-later
# Everything comes from Debian 12's packages (README).  Two of their CMake files are broken there:
# OpenSubdivConfig.cmake lists static libraries that are not shipped, and the OpenImageIO target names an
# OpenCV include folder that need not exist.
find_package(TBB REQUIRED)
find_package(Python 3.11 EXACT REQUIRED COMPONENTS Interpreter Development.Module)
find_package(pybind11 REQUIRED)
find_package(embree 3 REQUIRED)
find_package(hwy QUIET)
find_package(PkgConfig REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)

find_library(OSD_CPU_LIBRARY osdCPU REQUIRED)
find_path(OSD_INCLUDE_DIR opensubdiv/bfr/surface.h REQUIRED)
add_library(granita_osd INTERFACE)
target_link_libraries(granita_osd INTERFACE ${OSD_CPU_LIBRARY})
target_include_directories(granita_osd SYSTEM INTERFACE ${OSD_INCLUDE_DIR})

find_library(OIIO_LIBRARY OpenImageIO REQUIRED)
find_library(OIIO_UTIL_LIBRARY OpenImageIO_Util REQUIRED)
find_path(OIIO_INCLUDE_DIR OpenImageIO/texture.h REQUIRED)
add_library(granita_oiio INTERFACE)
target_link_libraries(granita_oiio INTERFACE ${OIIO_LIBRARY} ${OIIO_UTIL_LIBRARY})
target_include_directories(granita_oiio SYSTEM INTERFACE ${OIIO_INCLUDE_DIR})
