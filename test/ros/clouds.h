// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <limits>

#include "table_scene.h"

namespace voxid::test {

/// The scene as a driver's organised cloud: a point a pixel, NaN where there is no depth.
inline sensor_msgs::PointCloud2Ptr organisedCloud(const std::vector<std::uint16_t>& depth_mm, const ros::Time& stamp) {
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header.stamp = stamp;
  cloud->header.frame_id = "camera";
  sensor_msgs::PointCloud2Modifier modifier(*cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(depth_mm.size());
  cloud->width = TableScene::kWidth;
  cloud->height = TableScene::kHeight;
  cloud->row_step = cloud->width * cloud->point_step;
  sensor_msgs::PointCloud2Iterator<float> xyz(*cloud, "x");
  for (std::size_t i = 0; i < depth_mm.size(); ++i, ++xyz) {
    const int u = static_cast<int>(i % TableScene::kWidth), v = static_cast<int>(i / TableScene::kWidth);
    const float z = depth_mm[i] == 0 ? std::numeric_limits<float>::quiet_NaN() : depth_mm[i] / 1000.0f;
    xyz[0] = static_cast<float>((u - TableScene::kCx_px) / TableScene::kFocal_px) * z;
    xyz[1] = static_cast<float>((v - TableScene::kCy_px) / TableScene::kFocal_px) * z;
    xyz[2] = z;
  }
  return cloud;
}

}  // namespace voxid::test
