#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a grasp planner does with VOXID_OBJECTS, with nothing but Python's standard library: a line an object, and the
nearest one of a wanted label. Ends after --seconds or --count messages; exits 1 if none arrived.

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


def show(objects, wanted):
    for o in objects.objects:
        position = ",".join(f"{x:.3f}" for x in o.position_m)
        print(f"object utime={objects.utime} number={o.number} label={o.label} score={o.score:.3f} model={o.model} "
              f"view={o.view} position_m={position}")
    nearest = min((o for o in objects.objects if wanted in ("", o.label)), key=distance_m, default=None)
    if nearest:
        print(f"grasp number={nearest.number} label={nearest.label} distance_m={distance_m(nearest):.3f}")
    sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--url", default="udpm://239.255.76.67:7667?ttl=0")
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--count", type=float, default=math.inf)
    parser.add_argument("--label", default="", help="pick the nearest of this category (default: of any)")
    parser.add_argument("--types", help="folder that holds the generated module")
    args = parser.parse_args()

    object_list_t = import_types(args.types)
    received = 0
    for payload in messages(join(args.url), args.seconds, args.count):
        received += 1
        show(object_list_t.decode(payload), args.label)
    print(f"received={received}")
    return 0 if received else 1


if __name__ == "__main__":
    sys.exit(main())
