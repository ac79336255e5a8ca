"""A CiA 402 drive on somebody else's CANopen stack: the package canopen's LocalNode as the slave.

What the stack does is left to it (SDO server, network management, PDO mapping and frames); what
is here is the drive behind it, with the profile's state machine. Its link does not move by itself.
"""

from __future__ import annotations

import canopen
from canopen.objectdictionary import ODVariable

NODE = 1
SYNC = 0x080
COUNTS, GEAR = 16384, 160  # of the motor's turn; motor turns per turn of the joint
SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED = 0x0250, 0x0231, 0x0233, 0x1237
# What the profile leaves to the maker: this maker has left it out.
LEFT_OUT = [0x6007, 0x605E, 0x60C2]


def bus(port: int, group: str, *, fd: bool) -> canopen.Network:
    network = canopen.Network()
    network.connect(interface="udp_multicast", channel=group, port=port, hop_limit=0, fd=fd)
    return network


def multicast_group(name: str) -> str:
    """As drivers/can/virtual_bus.h says."""
    value = 2166136261
    for letter in name.encode():
        value = (value ^ letter) * 16777619 % 2**32
    value ^= value >> 16
    return f"239.74.{value >> 8 & 255}.{value & 255}"


class LocalDrive:
    def __init__(self, network: canopen.Network, eds: str) -> None:
        objects = canopen.import_od(eds, NODE)
        for index in LEFT_OUT:
            del objects[index]
        del objects[0x1400].subindices[5]
        objects[0x608F][1].default = COUNTS
        objects[0x6091][1].default = GEAR
        self.node = network.create_node(NODE, objects)
        self.values = {0x6041: SWITCH_ON_DISABLED, 0x6064: 0, 0x606C: 0, 0x6077: 0}
        self.torque = 0  # thousandths
        self.mapped = False
        self.node.add_read_callback(lambda index, **_: self.values.get(index))
        self.node.add_write_callback(self.on_write)
        network.subscribe(SYNC, self.on_sync)
        self.node.nmt.state = "INITIALISING"  # sends the boot-up message
        self.node.nmt.state = "PRE-OPERATIONAL"

    def on_write(self, index: int, od: ODVariable, data: bytes, **_) -> None:
        if index == 0x6040:
            self.obey(od.decode_raw(data))
        if index == 0x6060:
            self.values[0x6061] = od.decode_raw(data)

    def on_sync(self, *_) -> None:
        """Answers with the state of this instant; then the command takes effect."""
        if self.node.nmt.state != "OPERATIONAL":
            self.mapped = False
            return
        if not self.mapped:
            self.node.tpdo.read()
            self.node.rpdo.read()
            self.mapped = True
        for pdo in self.node.tpdo.values():
            if not pdo.enabled or pdo.trans_type != 1:
                continue
            for variable in pdo.map:
                variable.raw = self.values[variable.index]
            pdo.transmit()
        if self.node.rpdo[1].is_received:
            self.obey(self.node.rpdo[1][0x6040].raw)
            self.torque = self.node.rpdo[1][0x6071].raw

    def obey(self, controlword: int) -> None:
        state = self.values[0x6041]
        if controlword & 0x02 == 0:
            state = SWITCH_ON_DISABLED
        elif controlword == 0x06:
            state = READY
        elif controlword == 0x07 and state == READY:
            state = SWITCHED_ON
        elif controlword == 0x0F and state == SWITCHED_ON:
            state = ENABLED
        self.values[0x6041] = state
