// SPDX-License-Identifier: BSD-3-Clause
// For users of PCL: the descriptor of a cloud.
#include <cstdio>

#include "voxid/pcl/shape_distribution.h"

int main() {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (int i = 0; i < 2500; ++i) cloud->push_back({0.002f * (i % 50), 0.003f * (i / 50), 0.8f + 1e-5f * i});

  voxid::ShapeDistributionEstimation<pcl::PointXYZ> estimation;
  pcl::PointCloud<pcl::Histogram<416>> signature;
  estimation.setInputCloud(cloud);
  estimation.compute(signature);

  if (signature.empty()) return 1;
  for (int bin = 0; bin < 32; ++bin) std::printf("%.0f ", signature[0].histogram[bin]);
  std::printf("\n");
}
