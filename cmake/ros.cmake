# Messages, reconfigurable parameters and the catkin package itself.
set(VOXID_CATKIN_COMPONENTS
  roscpp nodelet pluginlib message_filters dynamic_reconfigure diagnostic_updater camera_info_manager tf2_ros
  std_msgs std_srvs sensor_msgs geometry_msgs shape_msgs visualization_msgs diagnostic_msgs)
find_package(catkin REQUIRED COMPONENTS message_generation ${VOXID_CATKIN_COMPONENTS})

add_message_files(FILES
  AlignedModel.msg AlignedModels.msg Candidate.msg DroppedCluster.msg ModelPose.msg Object.msg Objects.msg Segment.msg Segments.msg TablePlane.msg)
add_service_files(FILES AlignObject.srv ClassifyCloud.srv ConfirmObject.srv)
generate_messages(DEPENDENCIES std_msgs sensor_msgs geometry_msgs shape_msgs)
generate_dynamic_reconfigure_options(cfg/Capture.cfg cfg/Segmentation.cfg cfg/Classification.cfg)

find_package(Eigen3 3.3 REQUIRED NO_MODULE)  # the geometry headers that are installed include it
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES voxid_core voxid_geometry
  CATKIN_DEPENDS message_runtime ${VOXID_CATKIN_COMPONENTS}
  DEPENDS EIGEN3
  CFG_EXTRAS voxid-extras.cmake)

install(FILES package.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(DIRECTORY launch rviz cfg DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
