# The core's sources and compiler options, for the package and for test/aarch64.
get_filename_component(core_root ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
set(core_sources)
foreach(stage geometry input sensor image tracking mapping odometry completion fusion preview scene pipeline settings tools)
  file(GLOB stage_sources CONFIGURE_DEPENDS ${core_root}/src/${stage}/*.cpp)
  list(APPEND core_sources ${stage_sources})
endforeach()
# Nobody looks at floating-point exceptions or errno, for which gcc would not vectorise comparisons and roots.
# Without contraction to fused multiply-adds every vector width gives the same bits.
set(core_compile_options -fno-trapping-math -fno-math-errno -ffp-contract=off)
