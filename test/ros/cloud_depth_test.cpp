// SPDX-License-Identifier: BSD-3-Clause
// Organised clouds become the depth images they were made of; others are refused with the reason.
#include "cloud_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "clouds.h"

namespace voxid {
namespace {

using test::organisedCloud;
using test::TableScene;

struct CloudDepthTest : testing::Test {
  CloudDepth converter;
  sensor_msgs::Image image;
  sensor_msgs::CameraInfo info;
  sensor_msgs::PointCloud2Ptr cloud = organisedCloud(TableScene().depth_mm(), ros::Time(7));

  float depthAt(std::size_t pixel) const {
    float z_m;
    std::memcpy(&z_m, &image.data[4 * pixel], 4);
    return z_m;
  }
  void expectRefused(const std::string& part) {
    const Status status = converter.convert(*cloud, &image, &info);
    EXPECT_EQ(status.kind, Status::Kind::BadUse);
    EXPECT_NE(status.sentence.find(part), std::string::npos) << status.sentence;
  }
};

TEST_F(CloudDepthTest, GivesBackDepthAndCamera) {
  ASSERT_TRUE(converter.convert(*cloud, &image, &info).ok());
  EXPECT_EQ(image.header.stamp, ros::Time(7));
  EXPECT_EQ(info.header.frame_id, "camera");
  EXPECT_EQ(image.encoding, "32FC1");
  EXPECT_EQ(image.width, 320u);
  EXPECT_EQ(info.height, 240u);
  const std::vector<std::uint16_t> depth_mm = TableScene().depth_mm();
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    if (depth_mm[i] == 0)
      ASSERT_TRUE(std::isnan(depthAt(i))) << i;
    else
      ASSERT_EQ(depthAt(i), depth_mm[i] / 1000.0f) << i;
  }
  EXPECT_NEAR(info.K[0], TableScene::kFocal_px, 0.01);
  EXPECT_NEAR(info.K[4], TableScene::kFocal_px, 0.01);
  EXPECT_NEAR(info.K[2], TableScene::kCx_px, 0.01);
  EXPECT_NEAR(info.K[5], TableScene::kCy_px, 0.01);
}

TEST_F(CloudDepthTest, RowsMayBePadded) {
  const auto padded = boost::make_shared<sensor_msgs::PointCloud2>(*cloud);
  padded->row_step += 64;
  padded->data.assign(std::size_t{padded->row_step} * padded->height, 0xff);
  for (std::uint32_t v = 0; v < cloud->height; ++v)
    std::memcpy(&padded->data[std::size_t{padded->row_step} * v], &cloud->data[std::size_t{cloud->row_step} * v],
                cloud->row_step);
  ASSERT_TRUE(converter.convert(*padded, &image, &info).ok());
  EXPECT_NEAR(info.K[5], TableScene::kCy_px, 0.01);
  const std::size_t middle = 120 * 320 + 160;
  EXPECT_EQ(depthAt(middle), TableScene().depth_mm()[middle] / 1000.0f);
}

TEST_F(CloudDepthTest, AnUnorganisedCloudIsRefused) {
  cloud->width *= cloud->height;
  cloud->height = 1;
  cloud->row_step *= 240;
  expectRefused("the cloud is not organised (76800 x 1 points)");
}

TEST_F(CloudDepthTest, AnotherFrameThanTheOpticalOneIsRefused) {
  sensor_msgs::PointCloud2Iterator<float> xyz(*cloud, "x");
  for (; xyz != xyz.end(); ++xyz) {  // x forward, y left, z up
    const float x = xyz[0], y = xyz[1], z = xyz[2];
    xyz[0] = z, xyz[1] = -x, xyz[2] = -y;
  }
  expectRefused("expected the optical frame");
}

TEST_F(CloudDepthTest, ABrokenCloudIsRefused) {
  cloud->data.resize(1000);
  expectRefused("has 1000 bytes");
}

TEST_F(CloudDepthTest, OtherFieldsAreRefused) {
  cloud->fields[2].datatype = sensor_msgs::PointField::FLOAT64;
  expectRefused("no field 'z' of float32");
  cloud->fields.clear();
  expectRefused("no field 'x' of float32");
}

TEST_F(CloudDepthTest, WithoutPointsTheCameraStays) {
  ASSERT_TRUE(converter.convert(*cloud, &image, &info).ok());
  const double fx_px = info.K[0];
  const auto nothing = organisedCloud(std::vector<std::uint16_t>(320 * 240, 0), ros::Time(8));
  ASSERT_TRUE(converter.convert(*nothing, &image, &info).ok());
  EXPECT_EQ(info.K[0], fx_px);
  EXPECT_TRUE(std::isnan(depthAt(0)));
  CloudDepth fresh;
  ASSERT_TRUE(fresh.convert(*nothing, &image, &info).ok());
  EXPECT_EQ(info.K[0], 262.5);
}

}  // namespace
}  // namespace voxid
