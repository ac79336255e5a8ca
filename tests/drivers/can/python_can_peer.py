"""The other end of test_virtual_bus: prints each frame it hears and answers with the next id."""

import sys

import can

HELLO, GOODBYE = 0x701, 0x700


def text(message: can.Message) -> str:
    flags = "".join(
        (
            "X" if message.is_extended_id else "S",
            "R" if message.is_remote_frame else "-",
            "E" if message.is_error_frame else "-",
            "F" if message.is_fd else "-",
            "B" if message.bitrate_switch else "-",
        )
    )
    return f"{message.arbitration_id:x} {flags} {message.dlc} {message.data.hex()}"


def main(group: str, port: int) -> None:
    with can.Bus(interface="udp_multicast", channel=group, port=port, hop_limit=0, fd=True) as bus:
        bus.send(can.Message(arbitration_id=HELLO, is_extended_id=False))
        while message := bus.recv(timeout=10):
            if message.arbitration_id % 2 == 1:  # our own frames come back: they are the odd ones
                continue
            if message.arbitration_id == GOODBYE:
                return
            print(text(message), flush=True)
            message.arbitration_id += 1
            bus.send(message)


main(sys.argv[1], int(sys.argv[2]))
