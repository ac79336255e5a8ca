"""Five channels at 2 kHz each: 10,000 numbered messages a second, for ever."""

import time

import lcm

from limber import messages

# Those of fixed size that come at a rate.
CHANNELS = ("JOINT_STATE", "JOINT_TORQUE", "CONTROLLER_STATUS", "DRIVER_STATUS", "SIM_TRUTH")
RATE_HZ = 2000  # of each channel


def publish() -> None:
    """A burst each millisecond."""
    line = lcm.LCM(messages.user_plane_url())
    types = {name: messages.channels()[name].type_name for name in CHANNELS}
    blank = {name: bytearray(messages.message_class(t)().encode()) for name, t in types.items()}
    seq, due = 0, time.monotonic()
    while True:
        for _ in range(RATE_HZ // 1000):
            seq += 1
            for name, data in blank.items():
                data[8:16] = seq.to_bytes(8, "big")
                line.publish(name, bytes(data))
        due += 1e-3
        time.sleep(max(0.0, due - time.monotonic()))


if __name__ == "__main__":
    publish()
