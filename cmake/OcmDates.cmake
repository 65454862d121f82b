# A file of CMake that is dated in the future is newer than all that is made of it, so that Ninja would configure again and
# again. A minute is for the clocks of two machines.
execute_process(
  COMMAND find "${CMAKE_CURRENT_LIST_DIR}/.." ( -name .git -o -name "build*" ) -prune -o
          ( -name CMakeLists.txt -o -name "*.cmake" -o -name CMakePresets.json ) -newermt "1 minute" -print -quit
  OUTPUT_VARIABLE early OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(early)
  get_filename_component(early "${early}" ABSOLUTE)
  message(FATAL_ERROR "${early} is dated in the future: set this machine's clock, or touch that file")
endif()
