# The capture nodelet on a replayed folder, through the real OpenNI2.
voxid_ros_program(capture_nodelet_test SOURCES capture_nodelet_test.cpp LINK opencv_core opencv_imgcodecs)
target_include_directories(capture_nodelet_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(capture_nodelet_test PRIVATE
  VOXID_BIN="${PROJECT_BINARY_DIR}/bin" VOXID_NODES="${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}")
add_dependencies(capture_nodelet_test voxid_replay_driver voxid_node_capture voxid_chain_bench)
voxid_rostest(capture_nodelet.test openni2:=${PROJECT_BINARY_DIR}/openni2)
