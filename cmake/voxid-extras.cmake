# The targets of an installed voxid. Without ROS this is the package file itself; with ROS catkin's includes it.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.3)  # the headers of voxid::geometry include it
include("${voxid_DIR}/voxidTargets.cmake")
