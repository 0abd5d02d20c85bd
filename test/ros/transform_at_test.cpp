// SPDX-License-Identifier: BSD-3-Clause
#include "transform_at.h"

#include <gtest/gtest.h>

namespace voxid {
namespace {

/// The camera rises by a metre a second above the table, from time 10 to time 11.
class TransformAt : public testing::Test {
 protected:
  TransformAt() {
    for (const double at_s : {10.0, 10.5, 11.0}) {
      geometry_msgs::TransformStamped transform;
      transform.header.stamp = ros::Time(at_s);
      transform.header.frame_id = "table";
      transform.child_frame_id = "camera";
      transform.transform.translation.z = at_s - 10;
      transform.transform.rotation.w = 1;
      transforms_.setTransform(transform, "test");
    }
  }
  double heightAt(double at_s, int tolerance_ms) const {
    return transformAt(transforms_, "table", "camera", ros::Time(at_s), tolerance_ms).transform.translation.z;
  }

  tf2_ros::Buffer transforms_{ros::Duration(10), false};
};

TEST_F(TransformAt, IsBetweenThoseAroundTheStamp) { EXPECT_NEAR(heightAt(10.25, 50), 0.25, 1e-6); }

TEST_F(TransformAt, IsTheNewestWhereTheNextHasNotCome) {
  EXPECT_NEAR(heightAt(11.04, 50), 1, 1e-6);
  EXPECT_THROW(heightAt(11.06, 50), tf2::ExtrapolationException);
  EXPECT_THROW(heightAt(11.001, 0), tf2::ExtrapolationException);
}

TEST_F(TransformAt, DoesNotReachBackBeforeTheFirst) {
  EXPECT_THROW(heightAt(9.99, 50), tf2::ExtrapolationException);
}

TEST_F(TransformAt, OfAFrameThatNobodyKnowsIsNone) {
  EXPECT_THROW(transformAt(transforms_, "nowhere", "camera", ros::Time(10), 50), tf2::LookupException);
}

}  // namespace
}  // namespace voxid
