# Parsing Eigen, OpenCV and GoogleTest is most of the time that a small file takes. ccache does not keep what is
# compiled with precompiled headers: with it there are none.
function(precompile_headers target)
  if(NOT "${CMAKE_CXX_COMPILER_LAUNCHER}" MATCHES "ccache")
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/Geometry> <opencv2/core.hpp>
      <opencv2/imgproc.hpp> <algorithm> <functional> <memory> <optional> <sstream> <string> <vector> ${ARGN})
  endif()
endfunction()

# For targets in which nothing is hot: optimising their templates takes longer than it ever saves.
add_library(${PROJECT_NAME}_compiled_fast INTERFACE)
target_compile_options(${PROJECT_NAME}_compiled_fast INTERFACE $<$<CONFIG:Release>:-O1>)
