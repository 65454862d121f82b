# Installs the build BUILD, then moves the result to PREFIX and looks at it: what works there does not depend on
# where it was installed, nor on what an earlier run left there.
set(staged ${PREFIX}.staged)
file(REMOVE_RECURSE ${PREFIX} ${staged})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${staged}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${staged} ${PREFIX})

foreach(file bin/amiroctl bin/ocm-generate include/ocm/topics/amiro.hpp include/ocm/c/client.h share/cmake/ocm/ocmConfig.cmake
             share/ocm/spec/topics.json share/ocm/spec/topics.schema.json share/ocm/spec/operator.schema.json
             share/ocm/examples/guard.operator.json share/ocm/examples/amiroctl-operator.service share/doc/ocm/LICENSE
             share/man/man1/amiroctl.1 share/man/man1/amiroctl-publish.1 share/man/man1/ocm-generate.1
             share/bash-completion/completions/amiroctl share/zsh/site-functions/_amiroctl
             share/fish/vendor_completions.d/amiroctl.fish)
  if(NOT EXISTS ${PREFIX}/${file})
    message(FATAL_ERROR "${file} was not installed")
  endif()
endforeach()

# Nothing may name the build or the first prefix.
file(GLOB_RECURSE texts ${PREFIX}/share/cmake/*)
foreach(text IN LISTS texts)
  file(READ ${text} content)
  foreach(path ${BUILD} ${staged})
    string(FIND "${content}" "${path}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${text} names ${path}: the installation cannot be moved")
    endif()
  endforeach()
endforeach()

# The installed tool with the installed spec, from anywhere. [Thesis 4.2: the magnetometer every 900 us]
execute_process(COMMAND ${PREFIX}/bin/amiroctl --spec ${PREFIX}/share/ocm/spec/topics.json publish mag 900us --dry-run
                WORKING_DIRECTORY / OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
if(NOT said STREQUAL "205#01840302")
  message(FATAL_ERROR "the installed amiroctl says '${said}', expected 205#01840302")
endif()

# The installed operator, with the schema beside it.
execute_process(COMMAND ${PREFIX}/bin/amiroctl operate ${PREFIX}/share/ocm/examples/guard.operator.json --check
                WORKING_DIRECTORY / OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(READ ${PREFIX}/share/ocm/examples/guard.operator.json guard)
string(JSON schema GET "${guard}" $schema)
if(NOT said MATCHES "in time$" OR NOT EXISTS ${PREFIX}/share/ocm/examples/${schema})
  message(FATAL_ERROR "the installed guard names ${schema}; of it amiroctl says '${said}'")
endif()
