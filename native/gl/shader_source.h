// SPDX-License-Identifier: GPL-3.0-or-later
// The text of the shaders: files under shaders/, embedded by the build.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace granita::gl {

using Defines = std::vector<std::pair<std::string, std::string>>;

/// The embedded file, e.g. "raster/grid.vert".  Throws GlError where there is none.
std::string_view embedded_text(std::string_view name);

/// A complete shader: `#version 450 core`, the defines, then the embedded file with its
/// `#include "name"` lines replaced by those files, each once.  `#include <...>` lines, meant for
/// C++, are left out.
std::string shader_source(std::string_view name, const Defines& defines = {});

namespace detail {
struct EmbeddedText {
    const char* name;
    const char* text;
};
/// Ends with a null name.
extern const EmbeddedText kEmbeddedTexts[];
}  // namespace detail

}  // namespace granita::gl
