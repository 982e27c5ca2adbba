# -DRGBD_SFM_FUSION_FUZZ=ON with -DCMAKE_CXX_COMPILER=clang++: programs that feed random input to what reads files
# and messages (libFuzzer), with everything that they use checking itself.
option(RGBD_SFM_FUSION_FUZZ "Build the fuzz targets; they need clang" OFF)
if(RGBD_SFM_FUSION_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "RGBD_SFM_FUSION_FUZZ needs libFuzzer, which comes with clang; the compiler is "
      "${CMAKE_CXX_COMPILER}. Configure an empty folder with -DCMAKE_CXX_COMPILER=clang++.")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
  # The compiler of everybody else decides which warnings are errors.
  target_compile_options(${PROJECT_NAME}_warnings INTERFACE -Wno-error)
endif()

# To be called when the libraries are known. Each test/fuzz/NAME.cpp is a target of its own, all of them `fuzz_targets`.
function(add_fuzz_targets)
  if(NOT RGBD_SFM_FUSION_FUZZ)
    return()
  endif()
  add_custom_target(fuzz_targets)
  file(GLOB sources CONFIGURE_DEPENDS test/fuzz/*.cpp)
  foreach(source ${sources})
    get_filename_component(name ${source} NAME_WE)
    #catkin_lint: ignore uninstalled_target
    add_executable(${name} ${source})
    target_include_directories(${name} PRIVATE test/fuzz)
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    target_link_libraries(${name} ${PROJECT_NAME}_ros ${PROJECT_NAME}_warnings)
    add_dependencies(fuzz_targets ${name})
  endforeach()
endfunction()
