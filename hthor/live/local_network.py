"""The names and addresses by which other machines of the local network reach this one."""

from __future__ import annotations

import fcntl
import ipaddress
import socket
import struct

_SIOCGIFADDR = 0x8915
"""Linux: the request for the IPv4 address of a network interface, see netdevice(7)."""
_REQUEST = struct.Struct("16s4x4s16x")
"""struct ifreq: the interface's name, and behind the address's family and port four bytes of address."""
EVERYWHERE = "0.0.0.0"
"""Where a server listens that all of the machine's networks reach."""


def host_name() -> str:
    """This machine's name, as browsers write it."""
    return socket.gethostname().lower()


def addresses() -> tuple[str, ...]:
    """This machine's IPv4 addresses that other machines may reach, one for each network interface that has one."""
    found = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            try:
                answer = fcntl.ioctl(probe, _SIOCGIFADDR, _REQUEST.pack(name.encode(), b""))
            except OSError:  # the interface has no address
                continue
            found.append(ipaddress.IPv4Address(_REQUEST.unpack(answer)[1]))
    return tuple(str(one) for one in dict.fromkeys(found) if not one.is_loopback)
