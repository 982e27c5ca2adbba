# `cpack` in the build folder makes a package for dpkg, of what CMake installs. It is for the release of Debian or Ubuntu
# that it is made on: which packages its libraries are in is looked up there.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ${PROJECT_NAME})
string(REPLACE "_" "-" CPACK_PACKAGE_NAME ${CPACK_PACKAGE_NAME}) # dpkg allows no underscore
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "${${PROJECT_NAME}_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "depth of an RGB-D camera fused with depth from structure from motion")
set(CPACK_PACKAGE_DESCRIPTION "Every pixel gets a depth, a variance and its source, live on ROS 1 or from a bag.")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
# Hidden, as roslaunch finds launch files in all other folders below the package.
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/.deb)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What libraries do not tell: programs that launch files and scripts start.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libnodeletlib-tools, python3-matplotlib, python3-numpy, python3-opencv, \
python3-rosbag, python3-roslaunch, python3-rospy, python3-sensor-msgs, python3-tf2-msgs, python3-yaml, rosbash, tf2-tools")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "rviz")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libdepth-image-proc-dev") # register_depth:=true
if(CMAKE_SOURCE_DIR STREQUAL PROJECT_SOURCE_DIR) # not of a whole workspace
  include(CPack)
endif()
