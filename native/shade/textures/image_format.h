// SPDX-License-Identifier: GPL-3.0-or-later
// Which reader an image file is given to.
#pragma once

#include <string>

namespace granita {

struct ImageFormat {
    const char* reader =
        nullptr;        ///< OpenImageIO's name for it; nullptr: none is trusted with the file
    std::string error;  ///< why, in words for the artist
};

/// By its first bytes, as Blender tells formats, never by trying one reader after another.
///
/// Only readers that damaged files could not bring down are used (bench/damaged_images.cpp).
/// OpenImageIO 2.4's for DPX, SGI and IFF write beyond their memory or abort; for these Blender
/// hands over pixels.
ImageFormat image_format(const std::string& path);

}  // namespace granita
