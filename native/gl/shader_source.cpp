// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/shader_source.h"

#include <set>
#include <sstream>

#include "base/error.h"

namespace granita::gl {
namespace {

void append_file(const std::string& name, std::set<std::string>& seen, std::string& out) {
    if (!seen.insert(name).second) return;
    std::istringstream lines{std::string(embedded_text(name))};
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("#include \"", 0) == 0) {
            const std::size_t begin = line.find('"') + 1, end = line.rfind('"');
            append_file(line.substr(begin, end - begin), seen, out);
        } else if (line.rfind("#include", 0) != 0 && line.rfind("#pragma once", 0) != 0) {
            out += line + "\n";
        }
    }
}

}  // namespace

std::string_view embedded_text(std::string_view name) {
    for (const detail::EmbeddedText* e = detail::kEmbeddedTexts; e->name != nullptr; ++e)
        if (name == e->name) return e->text;
    throw GlError("no embedded shader '" + std::string(name) + "'");
}

std::string shader_source(std::string_view name, const Defines& defines) {
    std::string source = "#version 450 core\n";
    for (const auto& [key, value] : defines)
        source.append("#define ").append(key).append(" ").append(value).append("\n");
    std::set<std::string> seen;
    append_file(std::string(name), seen, source);
    return source;
}

}  // namespace granita::gl
