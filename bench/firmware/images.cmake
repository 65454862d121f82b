# The boards under load: firmware/CMakeLists.txt includes this with -DOCM_BENCH=ON; bench/firmware/run runs them.
#
# A kernel of their own, which idles without sleeping: while a processor of QEMU sleeps, its threads race for how far
# virtual time goes, and with -icount an alarm came up to 4 ms late. Awake, every run is the same to the instruction.
set(busy CORTEX_ENABLE_WFI_IDLE=FALSE)
set(qemu_m3_busy_script ${qemu_m3_script})
set(qemu_m4_busy_script ${qemu_m4_script})
add_qemu_chip(qemu_m3_busy STM32F2xx "STM32F2XX;STM32F207xx;${busy}" 32 15 ${m3})
add_qemu_chip(qemu_m4_busy STM32F4xx "STM32F4XX;STM32F405xx;${busy}" 32 21 ${m4})

foreach(image "di_wheel_drive;qemu_m3_busy" "power_management;qemu_m4_busy")
  list(GET image 0 board)
  list(GET image 1 chip)
  foreach(spread 3000 180)  # us between two requests: 180 is as fast as the bus brings them
    ocm_add_image(BOARD load_${spread}_${board} CHIP ${chip} MAIN_STACK 0x800
      SOURCES ${repository}/bench/firmware/load_${board}.cpp qemu/machine.cpp qemu/give_up.cpp DEFINES OCM_LOAD_SPREAD_US=${spread})
  endforeach()
endforeach()
foreach(image "di_wheel_drive;qemu_m3_busy" "power_management;qemu_m4_busy")
  list(GET image 0 board)
  list(GET image 1 chip)
  ocm_add_image(BOARD load_behaviour_${board} CHIP ${chip} MAIN_STACK 0x800
    SOURCES ${repository}/bench/firmware/load_${board}.cpp qemu/machine.cpp qemu/give_up.cpp DEFINES OCM_LOAD_BEHAVIOUR OCM_LOAD_SPREAD_US=3000)
endforeach()
# What jobs take: the speed controllers, which are more urgent than all, by themselves.
foreach(image "costs_di_wheel_drive;di_wheel_drive;qemu_m3_busy;OCM_LOAD_WITHOUT_CONTROL" "costs_power_management;power_management;qemu_m4_busy;"
              "costs_control_di_wheel_drive;di_wheel_drive;qemu_m3_busy;OCM_LOAD_OWN_TASKS")
  list(GET image 0 name)
  list(GET image 1 board)
  list(GET image 2 chip)
  list(GET image 3 what)
  ocm_add_image(BOARD load_${name} CHIP ${chip} MAIN_STACK 0x800
    SOURCES ${repository}/bench/firmware/load_${board}.cpp qemu/machine.cpp qemu/give_up.cpp DEFINES OCM_LOAD_COSTS OCM_LOAD_SPREAD_US=3000 ${what})
endforeach()
