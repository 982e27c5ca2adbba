# The virtual camera, a driver that an unmodified libOpenNI2 loads. OpenNI2 looks for drivers beside the library
# file that was loaded, so this folder has a link to the library: LD_LIBRARY_PATH=<folder> is all that it takes.
set(virtual_camera_dir ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}/virtual_camera)
set(virtual_camera_destination ${CATKIN_PACKAGE_BIN_DESTINATION}/virtual_camera)

file(GLOB virtual_driver_sources CONFIGURE_DEPENDS src/virtual_driver/*.cpp)
add_library(VirtualAstra MODULE ${virtual_driver_sources})
target_include_directories(VirtualAstra SYSTEM PRIVATE ${OPENNI2_INCLUDE_DIRS})
# Never unloaded with its libraries, whose threads and statics may not survive that.
target_link_options(VirtualAstra PRIVATE -Wl,-z,nodelete)
target_link_libraries(VirtualAstra PRIVATE ${PROJECT_NAME}_core ${PROJECT_NAME}_warnings)
set_target_properties(VirtualAstra PROPERTIES
  SUFFIX .so.0 # OpenNI2 asks for it
  LIBRARY_OUTPUT_DIRECTORY ${virtual_camera_dir}/OpenNI2/Drivers
  INSTALL_RPATH "\$ORIGIN/../../../..")

find_library(openni2_library OpenNI2 HINTS ${OPENNI2_LIBRARY_DIRS})
if(NOT openni2_library)
  message(FATAL_ERROR "libOpenNI2.so was not found. Debian has it in the package libopenni2-dev.")
endif()
get_filename_component(openni2_library ${openni2_library} REALPATH)
file(MAKE_DIRECTORY ${virtual_camera_dir})
file(CREATE_LINK ${openni2_library} ${virtual_camera_dir}/libOpenNI2.so.0 SYMBOLIC)

# A wrapper that sets it, beside the folder. Not in scripts: rosrun looks there, too, and does not choose between two of
# a name. So it is put there by a whole build only, not in each folder that was configured.
set(with_virtual_camera ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}/with_virtual_camera)
add_custom_target(with_virtual_camera ALL
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${PROJECT_SOURCE_DIR}/cmake/with_virtual_camera.in ${with_virtual_camera})
add_dependencies(VirtualAstra with_virtual_camera)

#catkin_lint: ignore external_file
install(PROGRAMS ${with_virtual_camera} DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(TARGETS VirtualAstra LIBRARY DESTINATION ${virtual_camera_destination}/OpenNI2/Drivers)
#catkin_lint: ignore external_file
install(FILES ${virtual_camera_dir}/libOpenNI2.so.0 DESTINATION ${virtual_camera_destination})
