# Another python3 first in PATH (conda, pyenv) makes catkin fail in ways that do not name the reason.
execute_process(COMMAND python3 -c "import catkin_pkg"
  RESULT_VARIABLE python_result OUTPUT_QUIET ERROR_QUIET)
if(NOT python_result EQUAL 0)
  execute_process(COMMAND which python3 OUTPUT_VARIABLE python_path OUTPUT_STRIP_TRAILING_WHITESPACE)
  message(FATAL_ERROR "python3 (\"${python_path}\") cannot import catkin_pkg. Put the folder of the python3 that "
    "ROS was installed for first in PATH, e.g. PATH=/usr/bin:$PATH, and configure in an empty build folder.")
endif()
