#[[
ocm_generate_topics(TARGET <target> SPEC <file.json> [HEADER <name.hpp>])

Makes the C++ header of a robot's spec and lets <target> include it: `#include <name.hpp>`. The name is the
spec's by default: theirs.json makes theirs.hpp. It is made again when the spec changes; a spec with a mistake
stops the build with a message. The target needs ocm::ocm for what the header includes.

The program that makes it runs on the machine that builds, whatever is being built for. It is, in this order:
  1. OCM_GENERATE, when it is set: the path of an ocm-generate;
  2. the target ocm-generate, when this build has it and does not cross-compile;
  3. built here for the host, from ocm's sources (needs a C++20 compiler, nlohmann-json and valijson on the
     host; OCM_HOST_CXX names the compiler, c++ by default);
  4. the ocm-generate that is installed beside this file, or on the PATH.
]]

# Sets in the caller's scope: ocm_generator, the command; ocm_generator_depends, what must be built before.
function(_ocm_find_generator)
  set(depends "")
  set(host_project ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../generator/host)
  if(OCM_GENERATE)
    get_filename_component(generator "${OCM_GENERATE}" ABSOLUTE BASE_DIR ${CMAKE_BINARY_DIR})
    if(NOT EXISTS ${generator})
      message(FATAL_ERROR "OCM_GENERATE is ${OCM_GENERATE}, which does not exist. "
                          "Set it to the path of an ocm-generate that runs on this machine, or leave it unset.")
    endif()
  elseif(TARGET ocm-generate AND NOT CMAKE_CROSSCOMPILING)
    set(generator $<TARGET_FILE:ocm-generate>)
    set(depends ocm-generate)
  elseif(EXISTS ${host_project}/CMakeLists.txt)
    set(build_dir ${CMAKE_BINARY_DIR}/ocm-generate-host)
    set(generator ${build_dir}/ocm-generate)
    set(depends ocm-generate-host)
    if(NOT TARGET ocm-generate-host)
      include(ExternalProject)
      if(NOT OCM_HOST_CXX)
        set(OCM_HOST_CXX c++)
      endif()
      # Not optimised where one configuration is built: it runs for a tenth of a second once a changed spec, and the
      # optimiser takes a third of its compiler's time.
      # Nothing of the cross build may reach the host's: neither its toolchain file nor CC, CXX and flags.
      set(clean_env ${CMAKE_COMMAND} -E env --unset=CC --unset=CXX --unset=CFLAGS --unset=CXXFLAGS --unset=LDFLAGS
                    --unset=CMAKE_TOOLCHAIN_FILE --unset=CMAKE_GENERATOR)
      ExternalProject_Add(ocm-generate-host
        SOURCE_DIR ${host_project}
        BINARY_DIR ${build_dir}
        CONFIGURE_COMMAND ${clean_env} ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S <SOURCE_DIR> -B <BINARY_DIR>
                          -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=${OCM_HOST_CXX}
                          -DCMAKE_RUNTIME_OUTPUT_DIRECTORY=$<1:${build_dir}>
        BUILD_COMMAND ${clean_env} ${CMAKE_COMMAND} --build <BINARY_DIR> --config Release
        BUILD_ALWAYS ON
        BUILD_BYPRODUCTS ${generator}
        INSTALL_COMMAND "")
    endif()
  else()
    find_program(OCM_INSTALLED_GENERATE ocm-generate HINTS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../../bin
                 ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../../../bin  # lib/<triplet>/cmake/ocm
                 NO_CMAKE_FIND_ROOT_PATH)
    if(NOT OCM_INSTALLED_GENERATE)
      message(FATAL_ERROR "There is no ocm-generate beside this installation of ocm nor on the PATH. "
                          "Install ocm with its tools, or set OCM_GENERATE to the path of an ocm-generate.")
    endif()
    set(generator ${OCM_INSTALLED_GENERATE})
  endif()
  set(ocm_generator ${generator} PARENT_SCOPE)
  set(ocm_generator_depends ${depends} PARENT_SCOPE)
endfunction()

function(ocm_generate_topics)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "TARGET;SPEC;HEADER" "")
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES OR NOT arg_TARGET OR NOT arg_SPEC)
    message(FATAL_ERROR "ocm_generate_topics(${ARGV}): write "
                        "ocm_generate_topics(TARGET <target> SPEC <file.json> [HEADER <name.hpp>])")
  endif()
  if(NOT TARGET ${arg_TARGET})
    message(FATAL_ERROR "ocm_generate_topics: there is no target ${arg_TARGET}; call it after add_executable or add_library")
  endif()
  get_filename_component(spec ${arg_SPEC} ABSOLUTE)
  if(NOT EXISTS ${spec})
    message(FATAL_ERROR "ocm_generate_topics: there is no spec ${spec}")
  endif()
  if(NOT arg_HEADER)
    get_filename_component(stem ${spec} NAME_WE)
    set(arg_HEADER ${stem}.hpp)
  endif()

  set(folder ${CMAKE_CURRENT_BINARY_DIR}/ocm_topics/${arg_TARGET})
  set(header ${folder}/${arg_HEADER})
  get_filename_component(header_folder ${header} DIRECTORY)
  file(MAKE_DIRECTORY ${header_folder})

  _ocm_find_generator()
  set(generator_file ${ocm_generator_depends})
  if(NOT ocm_generator_depends OR ocm_generator_depends STREQUAL "ocm-generate-host")
    list(APPEND generator_file ${ocm_generator})
  endif()
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${ocm_generator} ${spec} -o ${header}
    DEPENDS ${spec} ${generator_file}
    COMMENT "Generating ${arg_HEADER} from ${arg_SPEC}"
    VERBATIM)

  string(MAKE_C_IDENTIFIER ${arg_HEADER} header_id)
  set(step ${arg_TARGET}_${header_id})
  add_custom_target(${step} DEPENDS ${header})
  add_dependencies(${arg_TARGET} ${step})
  get_target_property(type ${arg_TARGET} TYPE)
  if(type STREQUAL "INTERFACE_LIBRARY")
    target_include_directories(${arg_TARGET} INTERFACE $<BUILD_INTERFACE:${folder}>)
  else()
    target_include_directories(${arg_TARGET} PUBLIC $<BUILD_INTERFACE:${folder}>)
  endif()
endfunction()
