# SPDX-License-Identifier: GPL-3.0-or-later
# granita_embed_text(OUTPUT ROOTS dir... FILES file...): a C++ source with the files' text, each named
# relative to the root it lies under, as gl/shader_source.h looks them up.  Run as a script it writes
# that source.
if(CMAKE_SCRIPT_MODE_FILE)
  set(entries "")
  foreach(file IN LISTS FILES)
    foreach(root IN LISTS ROOTS)
      cmake_path(IS_PREFIX root ${file} under_root)
      if(under_root)
        file(RELATIVE_PATH name ${root} ${file})
      endif()
    endforeach()
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"embedded(${text})embedded\"},\n")
  endforeach()
  file(WRITE ${OUTPUT} "// Made by cmake/EmbedText.cmake; do not edit.
#include \"gl/shader_source.h\"\n
namespace granita::gl::detail {
const EmbeddedText kEmbeddedTexts[] = {\n${entries}    {nullptr, nullptr},\n};
}  // namespace granita::gl::detail\n")
  return()
endif()

set(GRANITA_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(granita_embed_text output)
  cmake_parse_arguments(ARG "" "" "ROOTS;FILES" ${ARGN})
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DROOTS=${ARG_ROOTS}" "-DFILES=${ARG_FILES}"
      -P ${GRANITA_EMBED_SCRIPT}
    DEPENDS ${ARG_FILES} ${GRANITA_EMBED_SCRIPT}
    COMMENT "Embedding shaders" VERBATIM)
endfunction()
