"""Which channels of a log are sent, and under which names."""

from collections.abc import Collection, Sequence

from limber import messages
from limber.errors import InputError


def is_command(channel: str) -> bool:
    """What moves an arm or its world: requests, pushes, and the controller's torques."""
    return channel == "JOINT_TORQUE" or messages.channels()[channel].sender == "user"


def choose(
    found: Collection[str],
    wanted: Sequence[str],
    commands_as: str,
    with_commands: bool,
) -> tuple[dict[str, str], dict[str, str]]:
    """Channel -> the name it is sent under; channel -> why it is not sent.

    `wanted`: all if empty. Commands are sent as they are if `with_commands`, else with the prefix
    `commands_as` if there is one. What is not limber's is sent if it is wanted by name: nobody here
    knows what it commands.
    """
    missing = [name for name in wanted if name not in found]
    if missing:
        raise InputError(f"no channel '{missing[0]}' in this log: {', '.join(sorted(found))}")
    sent, left_out = {}, {}
    for name in sorted(found):
        known = name in messages.channels()
        if wanted and name not in wanted:
            left_out[name] = "not in --channels"
        elif not known and not wanted:
            left_out[name] = "not a channel of limber's; --channels sends it"
        elif not known or not is_command(name) or with_commands:
            sent[name] = name
        elif commands_as:
            sent[name] = commands_as + name
        else:
            left_out[name] = "it commands; --commands-as REPLAY_ sends it under another name"
    clashes = sorted(set(sent.values()) & set(messages.channels()) - set(sent))
    if clashes:
        raise InputError(f"--commands-as {commands_as}: {clashes[0]} is a channel of limber's")
    return sent, left_out
