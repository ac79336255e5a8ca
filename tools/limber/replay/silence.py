"""Whether anything of a running stack is heard on an address."""

from limber.errors import RunError
from limber.live.line import Line

LIVE = ("JOINT_STATE", "CONTROLLER_STATUS", "DRIVER_STATUS", "ROBOT_INFO", "SIM_TRUTH")
WINDOWS, WINDOW_S = 10, 0.05  # ROBOT_INFO comes every 0.2 s, all else more often


def require_silence(line: Line, url: str) -> None:
    """RunError if a stack is heard. Short windows instead of one span of time: a pause of this
    process, or of the machine and all senders with it, costs one window, not the whole search.
    """
    heard: list[str] = []
    listening = [
        line.subscribe(name, lambda channel, _data: heard.append(channel)) for name in LIVE
    ]
    for _ in range(WINDOWS):
        if not heard:
            line.handle_timeout(int(WINDOW_S * 1000))
    for subscription in listening:
        line.unsubscribe(subscription)
    if heard:
        raise RunError(
            f"{heard[0]} is heard on {url}: a stack, or another replay, is running there; stop it, "
            "or send to a port of its own, such as --url udpm://239.255.76.67:7700?ttl=0"
        )
