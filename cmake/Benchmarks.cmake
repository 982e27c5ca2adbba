# For developers, so not installed.
option(RGBD_SFM_FUSION_BENCHMARKS "Build the benchmarks; they need Google Benchmark and OpenCV's rgbd" OFF)
if(RGBD_SFM_FUSION_BENCHMARKS)
  find_package(benchmark REQUIRED)
  #catkin_lint: ignore uninstalled_target
  add_executable(fusion_benchmark benchmark/fusion_benchmark.cpp)
  target_link_libraries(fusion_benchmark ${PROJECT_NAME}_core ${PROJECT_NAME}_warnings benchmark::benchmark opencv_rgbd)
  add_executable(recording_benchmark benchmark/recording_benchmark.cpp)
  target_link_libraries(recording_benchmark ${PROJECT_NAME}_ros ${PROJECT_NAME}_warnings CLI11::CLI11 opencv_rgbd)
endif()
