# Headers that are compiled once, and which a compiler's cache knows again.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(OCM_PRECOMPILED_OPTIONS -fpch-preprocess)
else()
  set(OCM_PRECOMPILED_OPTIONS "SHELL:-Xclang -fno-pch-timestamp")
endif()

# ocm_precompile(TARGET HEADER): makes TARGET the owner of HEADER, which others take with REUSE_FROM and with the same
# OCM_PRECOMPILED_OPTIONS.
function(ocm_precompile target header)
  target_precompile_headers(${target} PRIVATE ${header})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(launcher ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/precompile.sh ${CMAKE_CXX_COMPILER_LAUNCHER})
    set_target_properties(${target} PROPERTIES CXX_COMPILER_LAUNCHER "${launcher}")
  endif()
endfunction()
