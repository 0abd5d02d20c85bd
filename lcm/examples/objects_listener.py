#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The same consumer on ROS: prints what /voxid/objects says. Start: rosrun voxid objects_listener.py"""
import rospy
from voxid.msg import Objects


def show(message):
    if message.status != Objects.OK:
        rospy.loginfo("%s", message.status_text)
    for o in message.objects:
        p, e = o.pose.pose.position, o.extents_m
        print(f"object number={o.number} label={o.label} score={o.score:.3f} frame={message.header.frame_id} "
              f"position_m={p.x:.3f},{p.y:.3f},{p.z:.3f} extents_m={e.x:.3f},{e.y:.3f},{e.z:.3f}", flush=True)


rospy.init_node("objects_listener", anonymous=True)
rospy.Subscriber("/voxid/objects", Objects, show, queue_size=2)
rospy.spin()
