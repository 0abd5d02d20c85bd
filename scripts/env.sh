# Source this to use the built package: . scripts/env.sh
# A master that runs already is kept; otherwise one on this machine's loopback is assumed.
_voxid_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
_voxid_devel=$_voxid_root/build/devel
export ROS_IP=${ROS_IP:-127.0.0.1} ROS_MASTER_URI=${ROS_MASTER_URI:-http://127.0.0.1:11311}
export ROS_HOME=${ROS_HOME:-$_voxid_root/.roshome}
export CMAKE_PREFIX_PATH=$_voxid_devel:/usr${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}
export LD_LIBRARY_PATH=$_voxid_devel/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export PYTHONPATH=$_voxid_root/build/python:$_voxid_devel/lib/python3/dist-packages${PYTHONPATH:+:$PYTHONPATH}
export ROS_PACKAGE_PATH=$_voxid_root:/usr/share
export PATH=$_voxid_root/scripts:$PATH
unset _voxid_root _voxid_devel
