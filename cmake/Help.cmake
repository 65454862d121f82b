# Manual pages and completion, made by the programs themselves and installed where man and the shells look for
# them. A cross build cannot run them, unless it has an emulator.
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "ocm: cross build without an emulator: no manual pages, no completion")
  return()
endif()

set(help ${PROJECT_BINARY_DIR}/help)
set(completions ${help}/amiroctl.bash ${help}/amiroctl.zsh ${help}/amiroctl.fish)
add_custom_command(
  OUTPUT ${help}/man1/amiroctl.1 ${help}/man1/ocm-generate.1 ${completions}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${help}/man1
  COMMAND amiroctl --config /dev/null man --all ${help}/man1
  COMMAND ocm-generate --man > ${help}/man1/ocm-generate.1
  COMMAND amiroctl --config /dev/null completion bash > ${help}/amiroctl.bash
  COMMAND amiroctl --config /dev/null completion zsh > ${help}/amiroctl.zsh
  COMMAND amiroctl --config /dev/null completion fish > ${help}/amiroctl.fish
  DEPENDS amiroctl ocm-generate
  COMMENT "Manual pages and completion")
add_custom_target(ocm_help ALL DEPENDS ${help}/man1/amiroctl.1 ${completions})

install(DIRECTORY ${help}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
install(FILES ${help}/amiroctl.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME amiroctl OPTIONAL)
install(FILES ${help}/amiroctl.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions
        RENAME _amiroctl OPTIONAL)
install(FILES ${help}/amiroctl.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d OPTIONAL)
