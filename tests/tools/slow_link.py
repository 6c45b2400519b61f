#!/usr/bin/env python3
"""A link between two network namespaces whose packets are late and of which some are lost: what `tc netem` does, on kernels without it too.

    slow_link.py NAMESPACE NAMESPACE DELAY_MS LOST_OF     one packet of LOST_OF is lost; the device is link0 at both ends

Prints `ready`; on SIGTERM how many packets came and how many of them were lost, and ends. The link ends with it.
"""
import collections
import fcntl
import os
import select
import signal
import struct
import subprocess
import sys
import time

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000  # linux/if_tun.h


def open_end(namespace):
    """A TUN device in that namespace, as the file that its packets are read from and written to."""
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    request = fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH22x", b"", IFF_TUN | IFF_NO_PI))
    name = request[:16].rstrip(b"\0").decode()
    subprocess.run(["ip", "link", "set", name, "netns", namespace, "name", "link0"], check=True)
    return end


def carry(ends, delay_s, lost_of, counts):
    others = dict(zip(ends, reversed(ends)))
    under_way = collections.deque()  # (time of arrival, end, packet)
    while True:
        wait = max(0, under_way[0][0] - time.monotonic()) if under_way else None
        for end in select.select(ends, [], [], wait)[0]:
            packet = os.read(end, 65536)
            counts["carried"] += 1
            if counts["carried"] % lost_of == 0:
                counts["lost"] += 1
            else:
                under_way.append((time.monotonic() + delay_s, others[end], packet))
        while under_way and under_way[0][0] <= time.monotonic():
            _, end, packet = under_way.popleft()
            try:
                os.write(end, packet)
            except OSError:  # nobody is there yet, or any more
                pass


def main():
    counts = {"carried": 0, "lost": 0}

    def finish(*_):
        print("{carried} packets, {lost} lost".format(**counts), flush=True)
        os._exit(0)

    signal.signal(signal.SIGTERM, finish)
    ends = [open_end(namespace) for namespace in sys.argv[1:3]]
    print("ready", flush=True)
    carry(ends, float(sys.argv[3]) / 1000, int(sys.argv[4]), counts)


main()
