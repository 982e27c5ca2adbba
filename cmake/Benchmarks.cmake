# For developers, so not installed.
option(RGBD_SFM_FUSION_BENCHMARKS "Build the benchmarks; they need Google Benchmark and OpenCV's rgbd" OFF)
if(RGBD_SFM_FUSION_BENCHMARKS)
  find_package(benchmark REQUIRED)
  #catkin_lint: ignore uninstalled_target
  foreach(benchmark fusion_benchmark odometry_benchmark)
    add_executable(${benchmark} benchmark/${benchmark}.cpp)
    target_link_libraries(${benchmark} ${PROJECT_NAME}_core ${PROJECT_NAME}_warnings CLI11::CLI11 benchmark::benchmark opencv_rgbd opencv_imgcodecs)
  endforeach()
endif()
