#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a grasp planner does with VOXID_OBJECTS, with nothing but Python's standard library: a line an object, the
nearest graspable one of a wanted label, and where a gripper is to go first. Ends after --seconds or --count messages;
exits 1 if none arrived.

The module of the message types is what lcm-gen makes of voxid.lcm; --types names the folder that holds it. (ROS's own
Python package is called voxid too: a program that wants both starts two processes, as robots do anyway.)
"""
import argparse
import math
import pathlib
import socket
import struct
import sys
import time
from urllib.parse import parse_qs, urlsplit

HERE = pathlib.Path(__file__).resolve().parent
TYPE_FOLDERS = [HERE.parent / "python", HERE.parents[1] / "build/lcm/python"]  # installed, in the repository
SHORT_MESSAGE = 0x4C433032  # "LC02": one datagram is one message; voxid sends no other


def import_types(folder):
    folders = [folder] if folder else TYPE_FOLDERS
    sys.path[:0] = [str(f) for f in folders if f and (pathlib.Path(f) / "voxid/object_list_t.py").exists()]
    try:
        from voxid import object_list_t
    except ImportError:
        sys.exit(f"planner_inbox.py: no LCM types in {' or '.join(map(str, folders))}: build voxid, or give --types")
    return object_list_t


def join(url):
    """A socket that hears the multicast group of an udpm:// url."""
    parts = urlsplit(url)
    if parts.scheme != "udpm" or not parts.port:
        sys.exit(f"planner_inbox.py: '{url}' is no url like udpm://239.255.76.67:7667?ttl=0")
    s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, int(parse_qs(parts.query).get("recv_buf_size", ["1048576"])[0]))
    s.bind((parts.hostname, parts.port))
    try:
        group = struct.pack("4sl", socket.inet_aton(parts.hostname), socket.INADDR_ANY)
        s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
    except OSError as error:
        sys.exit(f"planner_inbox.py: cannot join {url}: {error}; is there a multicast route? "
                 "(ip route add 224.0.0.0/4 dev lo)")
    return s


def payload_of(datagram, channel):
    """The message in a datagram of that channel; None for any other datagram."""
    if len(datagram) < 8 or struct.unpack_from(">I", datagram)[0] != SHORT_MESSAGE:
        return None
    name, _, payload = datagram[8:].partition(b"\0")
    return payload if name == channel.encode() else None


def messages(sock, seconds, count):
    end = time.monotonic() + seconds
    while count > 0 and time.monotonic() < end:
        sock.settimeout(min(0.2, max(0.001, end - time.monotonic())))
        try:
            payload = payload_of(sock.recv(65536), "VOXID_OBJECTS")
        except socket.timeout:
            continue
        if payload is not None:
            count -= 1
            yield payload


def distance_m(o):
    return math.dist(o.position_m, (0, 0, 0))


def approach_from_above(o, above_m=0.1):
    """Position 10 cm above the middle of the box's top, quaternion w, x, y, z. The box's z is the table's normal;
    turned by half about its x it points down, and y, along the shorter side, is what the fingers close in."""
    w, x, y, z = o.quat_wxyz
    up = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    height_m = o.extents_m[2] / 2 + above_m
    return [p + height_m * u for p, u in zip(o.position_m, up)], (-x, w, z, -y)


def graspable(o, wanted, opening_m):
    return wanted in ("", o.label, o.coarse) and not o.truncated and o.extents_m[1] <= opening_m


def digits(numbers):
    return ",".join(f"{x:.3f}" for x in numbers)


def show_grasp(o):
    position_m, quat_wxyz = approach_from_above(o)
    print(f"grasp number={o.number} label={o.label} distance_m={distance_m(o):.3f} width_m={o.extents_m[1]:.3f} "
          f"approach_m={digits(position_m)} quat_wxyz={digits(quat_wxyz)}")
    m = o.model_pose
    if m.status == m.ALIGNED:
        print(f"aligned number={o.number} model={m.label}/{m.model} scale_m={m.scale_m:.3f} fit_mm={m.fit_mm:.1f} "
              f"rotation_known={int(m.rotation_known)}")


def show(objects, wanted, opening_m):
    for o in objects.objects:
        print(f"object utime={objects.utime} number={o.number} label={o.label} score={o.score:.3f} coarse={o.coarse} "
              f"model={o.model} view={o.view} position_m={digits(o.position_m)}")
    nearest = min((o for o in objects.objects if graspable(o, wanted, opening_m)), key=distance_m, default=None)
    if nearest:
        show_grasp(nearest)
    sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--url", default="udpm://239.255.76.67:7667?ttl=0")
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--count", type=float, default=math.inf)
    parser.add_argument("--label", default="", help="pick the nearest of this category, or of what is only known to be "
                        "of this synset, as container.n.01 (default: of any)")
    parser.add_argument("--opening", type=float, default=0.08, help="of the gripper, metres (default: 0.08)")
    parser.add_argument("--types", help="folder that holds the generated module")
    args = parser.parse_args()

    object_list_t = import_types(args.types)
    received = 0
    for payload in messages(join(args.url), args.seconds, args.count):
        received += 1
        show(object_list_t.decode(payload), args.label, args.opening)
    print(f"received={received}")
    return 0 if received else 1


if __name__ == "__main__":
    sys.exit(main())
