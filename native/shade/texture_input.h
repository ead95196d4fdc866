// SPDX-License-Identifier: GPL-3.0-or-later
// Serves texture pyramids to OpenImageIO's cache as if they were mip-mapped files.
#pragma once

#include <OpenImageIO/imagecache.h>

#include <string>

#include "scene/node_graph.h"

namespace granita {

/// Makes `image` known under a name that is unique in the process, until the object dies.  The
/// image must outlive it.
class TextureRegistration {
  public:
    TextureRegistration(const Image& image, OIIO::ImageCache& cache);
    ~TextureRegistration();
    TextureRegistration(const TextureRegistration&) = delete;
    TextureRegistration& operator=(const TextureRegistration&) = delete;
    const std::string& name() const { return m_name; }

  private:
    std::string m_name;
};

}  // namespace granita
