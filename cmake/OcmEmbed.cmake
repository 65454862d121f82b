# ocm_embed(FILE [PATH...]): writes the source FILE with the contents of the files PATH in it, by their names, for
# cli/serve/assets.hpp. The assembler reads them, so that a large file costs no time; they are no longer needed when the
# program runs. Without any PATH there are none.
function(ocm_embed output)
  set(blobs "")
  set(entries "")
  set(number 0)
  foreach(path IN LISTS ARGN)
    get_filename_component(name ${path} NAME)
    string(APPEND blobs
           "extern \"C\" const char ocm_asset_${number}[], ocm_asset_${number}_end[];\n"
           "asm(\".pushsection .rodata\\n.global ocm_asset_${number}, ocm_asset_${number}_end\\nocm_asset_${number}: .incbin \\\"${path}\\\"\\n\"\n"
           "    \"ocm_asset_${number}_end: .byte 0\\n.popsection\");\n")
    string(APPEND entries
           "      {\"${name}\", {ocm_asset_${number}, static_cast<std::size_t>(ocm_asset_${number}_end - ocm_asset_${number})}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  if(entries)
    set(body "  static const Asset all[] = {\n${entries}  };\n  return all;\n")
  else()
    set(body "  return {};\n")
  endif()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT
"#include <cstddef>

#include \"cli/serve/assets.hpp\"

@blobs@
namespace ocm::cli::serve {

std::span<const Asset> assets() noexcept {
@body@}

}  // namespace ocm::cli::serve
")
  set_source_files_properties(${output} PROPERTIES OBJECT_DEPENDS "${ARGN}" SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
