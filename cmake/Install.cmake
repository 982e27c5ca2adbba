# What a user of the installed package needs. Executables are installed where they are declared.
install(TARGETS ${PROJECT_NAME}_camera ${PROJECT_NAME}_nodelets ${PROJECT_NAME}_ros ${PROJECT_NAME}_video
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
install(DIRECTORY config launch rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} OPTIONAL)
install(FILES nodelets.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} OPTIONAL)
install(PROGRAMS
  scripts/compare_runs scripts/evaluate_run scripts/export_run scripts/in_namespace scripts/play_bag scripts/record_run
  scripts/register_depth scripts/report_run scripts/show_results scripts/show_rviz
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
# fuse_bag calls report_run, which is beside it when installed. In the devel space a link leads to it, hidden from rosrun,
# which would ask which of the two is meant.
file(MAKE_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/scripts/report_run
  ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}/.report_run SYMBOLIC)

# --- The core for projects without ROS: find_package(rgbd_sfm_fusion), target rgbd_sfm_fusion::core -----------
# Config.cmake is found before, or replaces, the one that catkin makes, which asks for ROS. It brings that one in for
# catkin, as catkin.cmake. catkin's own files of these names go first: what is of the same second would not be replaced.
set(catkins_folder "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CATKIN_PACKAGE_LIB_DESTINATION}")
install(CODE "file(REMOVE \"${catkins_folder}/pkgconfig/${PROJECT_NAME}.pc\"
  \"${catkins_folder}/cmake/${PROJECT_NAME}/${PROJECT_NAME}Config.cmake\")")
set_target_properties(${PROJECT_NAME}_core PROPERTIES EXPORT_NAME core)
install(TARGETS ${PROJECT_NAME}_core EXPORT ${PROJECT_NAME}Targets
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
set(cmake_destination ${CATKIN_PACKAGE_LIB_DESTINATION}/cmake/${PROJECT_NAME})
install(EXPORT ${PROJECT_NAME}Targets NAMESPACE ${PROJECT_NAME}:: DESTINATION ${cmake_destination})
include(CMakePackageConfigHelpers)
configure_file(cmake/Config.cmake.in ${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}Config.cmake @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}ConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}Config.cmake
  ${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}ConfigVersion.cmake DESTINATION ${cmake_destination})
install(FILES ${PROJECT_BINARY_DIR}/catkin_generated/installspace/${PROJECT_NAME}Config.cmake
  DESTINATION ${cmake_destination} RENAME catkin.cmake)

file(RELATIVE_PATH pc_to_prefix /${CATKIN_PACKAGE_LIB_DESTINATION}/pkgconfig /)
configure_file(cmake/core.pc.in ${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/core/${PROJECT_NAME}.pc
  DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}/pkgconfig)
