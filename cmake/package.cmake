# What find_package(voxid) gives: voxid::core, voxid::geometry and voxid::pcl; with ROS through catkin's own package file.
add_library(voxid_pcl INTERFACE)  # headers alone; who uses them brings PCL
add_library(voxid::pcl ALIAS voxid_pcl)
target_link_libraries(voxid_pcl INTERFACE voxid_core)
foreach(part core geometry pcl)
  set_target_properties(voxid_${part} PROPERTIES EXPORT_NAME ${part})
endforeach()
install(TARGETS voxid_core voxid_geometry voxid_pcl EXPORT voxidTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT voxidTargets NAMESPACE voxid:: DESTINATION share/voxid/cmake)
if(VOXID_ROS)
  export(EXPORT voxidTargets NAMESPACE voxid:: FILE ${CATKIN_DEVEL_PREFIX}/share/voxid/cmake/voxidTargets.cmake)
else()
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file(voxidConfig-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES cmake/voxid-extras.cmake DESTINATION share/voxid/cmake RENAME voxidConfig.cmake)
  install(FILES ${PROJECT_BINARY_DIR}/voxidConfig-version.cmake DESTINATION share/voxid/cmake)
  install(DIRECTORY cfg DESTINATION share/voxid)
endif()
