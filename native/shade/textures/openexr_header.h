// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the header of an OpenEXR file can be what it says.
#pragma once

#include <string>

namespace granita {

/// False where an attribute would reach beyond the file's end.  OpenEXR's library takes memory for
/// each as large as it says before it reads it: 28 bytes took 2.1 GiB.
/// (https://openexr.com/en/latest/OpenEXRFileLayout.html)
bool openexr_header_fits(const std::string& path);

}  // namespace granita
