# ChibiOS, compiled once for a chip: the kernel RT 4 and, for real chips, the hardware layer HAL 5. scripts/setup
# fetches it; OCM_CHIBIOS (cache or environment) names another tree of the same major versions.
#
# Licences: the kernel is GPLv3, the HAL Apache-2.0 [license.txt of the package]; see firmware/README.md.

if(NOT OCM_CHIBIOS)
  set(tree "$ENV{OCM_CHIBIOS}")
  if(NOT tree)
    include(${CMAKE_CURRENT_LIST_DIR}/OcmCache.cmake)
    set(tree "${OCM_CACHE}/chibios")
  endif()
  set(OCM_CHIBIOS "${tree}" CACHE PATH "ChibiOS, the folder that holds os/rt")
endif()
if(NOT EXISTS "${OCM_CHIBIOS}/os/rt/include/ch.h")
  message(FATAL_ERROR "There is no ChibiOS in ${OCM_CHIBIOS}: run scripts/setup, or set OCM_CHIBIOS to the folder "
                      "that holds os/rt.")
endif()

# ocm_add_chibios(TARGET
#   FAMILY STM32F4xx          ChibiOS's folder of start-up code and CMSIS headers
#   DEFINES STM32F405xx ...   the device, and what the configuration asks for
#   OPTIONS -mcpu=...         how this core is compiled
#   CONFIG folder...          where chconf.h is found, and for HAL halconf.h, mcuconf.h and board.h
#   [HAL STM32F4xx driver...] the platform folder and its drivers: I2Cv1/i2c SPIv1/spi ...; without HAL the kernel alone, whose
#                             alarm comes from chcore_timer_alt.h in a CONFIG folder)
#
# An object library: vectors and start-up code must be linked although no code refers to them.
function(ocm_add_chibios target)
  cmake_parse_arguments(arg "" "FAMILY" "DEFINES;OPTIONS;CONFIG;HAL" ${ARGN})
  set(os ${OCM_CHIBIOS}/os)
  set(startup ${os}/common/startup/ARMCMx)
  set(port ${os}/common/ports/ARMCMx)
  set(sources
      ${startup}/compilers/GCC/crt0_v7m.s ${startup}/compilers/GCC/crt1.c ${startup}/compilers/GCC/vectors.c
      ${port}/compilers/GCC/chcoreasm_v7m.s ${port}/chcore.c ${port}/chcore_v7m.c
      ${os}/rt/src/chsys.c ${os}/rt/src/chdebug.c ${os}/rt/src/chvt.c ${os}/rt/src/chschd.c
      ${os}/rt/src/chthreads.c ${os}/rt/src/chsem.c ${os}/rt/src/chmtx.c)
  set(includes
      ${arg_CONFIG} ${os}/rt/include ${os}/common/oslib/include ${port} ${port}/compilers/GCC
      ${startup}/compilers/GCC ${startup}/devices/${arg_FAMILY} ${os}/common/ext/CMSIS/include
      ${os}/common/ext/CMSIS/ST/${arg_FAMILY})
  if(arg_HAL)
    list(POP_FRONT arg_HAL platform)
    list(APPEND includes ${os}/hal/include ${os}/hal/osal/rt ${os}/hal/ports/common/ARMCMx
         ${os}/hal/ports/STM32/${platform})
    list(APPEND sources ${os}/hal/src/hal.c ${os}/hal/osal/rt/osal.c ${os}/hal/ports/common/ARMCMx/nvic.c
         ${os}/hal/ports/STM32/${platform}/hal_lld.c)
    foreach(driver IN LISTS arg_HAL)  # FOLDER/NAME; DMAv1/dma has no upper half
      get_filename_component(folder ${driver} DIRECTORY)
      get_filename_component(name ${driver} NAME)
      list(APPEND includes ${os}/hal/ports/STM32/LLD/${folder})
      if(name STREQUAL "dma")
        list(APPEND sources ${os}/hal/ports/STM32/LLD/${folder}/stm32_dma.c)
      else()
        list(APPEND sources ${os}/hal/src/hal_${name}.c ${os}/hal/ports/STM32/LLD/${folder}/hal_${name}_lld.c)
      endif()
    endforeach()
  endif()

  add_library(${target} OBJECT ${sources})
  set_source_files_properties(${sources} PROPERTIES LANGUAGE C)
  set_source_files_properties(${startup}/compilers/GCC/crt0_v7m.s ${port}/compilers/GCC/chcoreasm_v7m.s
                              PROPERTIES LANGUAGE ASM)
  target_include_directories(${target} SYSTEM PUBLIC ${includes})
  target_compile_definitions(${target} PUBLIC ${arg_DEFINES} THUMB_PRESENT THUMB_NO_INTERWORKING
                                              CORTEX_USE_FPU=FALSE)
  target_link_options(${target} PUBLIC ${arg_OPTIONS})  # which chooses the C library of this core
  target_compile_options(${target}
    PUBLIC ${arg_OPTIONS} -ffunction-sections -fdata-sections -fno-common
    PRIVATE -w $<$<COMPILE_LANGUAGE:ASM>:-xassembler-with-cpp>)  # its warnings are its authors' business
endfunction()
