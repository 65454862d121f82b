# cmake --install: the headers, the CMake package, the programs, the AMiRo's spec. Wherever it is installed, the
# result may be moved: nothing in it names the prefix.
if(NOT OCM_INSTALL)
  return()
endif()

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/ocm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
install(TARGETS ocm EXPORT ocmTargets INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# share, not lib: headers are the same for every processor, so a cross build may use the package too.
set(package ${CMAKE_INSTALL_DATADIR}/cmake/ocm)
install(EXPORT ocmTargets NAMESPACE ocm:: DESTINATION ${package})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/ocmConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/ocmConfig.cmake
                              INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break what the one before it promised.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ocmConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/ocmConfig.cmake ${PROJECT_BINARY_DIR}/ocmConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/OcmGenerateTopics.cmake
        DESTINATION ${package})

if(OCM_TOOLS)
  install(TARGETS amiroctl ocm-generate RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  include(${CMAKE_CURRENT_LIST_DIR}/Help.cmake)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/spec/topics.json ${PROJECT_SOURCE_DIR}/spec/topics.schema.json
              ${PROJECT_SOURCE_DIR}/spec/operator.schema.json
        DESTINATION ${CMAKE_INSTALL_DATADIR}/ocm/spec)
# An operator to begin with, beside the schema that it names, and the unit that runs it.
install(FILES ${PROJECT_SOURCE_DIR}/examples/guard.operator.json ${PROJECT_SOURCE_DIR}/examples/amiroctl-operator.service
        DESTINATION ${CMAKE_INSTALL_DATADIR}/ocm/examples)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
