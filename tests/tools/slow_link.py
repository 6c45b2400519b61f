#!/usr/bin/env python3
"""Connects two network namespaces, and delays and drops network packets like `tc netem`, also on Linux kernels without netem.

    slow_link.py NAMESPACE NAMESPACE DELAY_MS LOST_OF     drops every LOST_OF-th packet; the network device is link0 at both ends

Prints `ready`; on SIGTERM prints the numbers of packets and of lost packets, and exits. The link exists until this process exits.
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
    """Creates a TUN device in the namespace. Returns the file descriptor of its packets."""
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    request = fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH22x", b"", IFF_TUN | IFF_NO_PI))
    name = request[:16].rstrip(b"\0").decode()
    subprocess.run(["ip", "link", "set", name, "netns", namespace, "name", "link0"], check=True)
    return end


def carry(ends, delay_s, lost_of, counts):
    """Forwards packets between the two ends until the process exits, and counts them in `counts`."""
    opposite_ends = dict(zip(ends, reversed(ends)))
    under_way = collections.deque()  # (time of arrival, receiving end of the link, packet)
    while True:
        wait = max(0, under_way[0][0] - time.monotonic()) if under_way else None
        for end in select.select(ends, [], [], wait)[0]:
            packet = os.read(end, 65536)
            counts["carried"] += 1
            if counts["carried"] % lost_of == 0:
                counts["lost"] += 1
            else:
                under_way.append((time.monotonic() + delay_s, opposite_ends[end], packet))
        while under_way and under_way[0][0] <= time.monotonic():
            _, end, packet = under_way.popleft()
            try:
                os.write(end, packet)
            except OSError:  # the receiving device is not up
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
