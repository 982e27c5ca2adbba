# What a user of the installed package needs. Executables are installed where they are declared.
install(TARGETS ${PROJECT_NAME}_camera ${PROJECT_NAME}_core ${PROJECT_NAME}_nodelets ${PROJECT_NAME}_ros
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
install(DIRECTORY config launch rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} OPTIONAL)
install(FILES nodelets.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION} OPTIONAL)
install(PROGRAMS
  scripts/evaluate_run scripts/in_namespace scripts/play_bag scripts/record_run scripts/register_depth scripts/show_results
  scripts/show_rviz
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY scripts/evaluation DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
  FILES_MATCHING PATTERN "*.py")
