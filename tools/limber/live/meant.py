"""What people say, and what it is called here."""

import math
from typing import Any

import yaml

from limber.errors import InputError

MEANT = {
    "stiffness": ("gains: {K_x_translation_N_per_m: 200}", "N/m at the tip; K_q_... at joints"),
    "damping": ("gains: {damping_ratio: 0.7}", "joint_damping_ratio for laws at the joints"),
    "compliance": ("gains: {K_x_translation_N_per_m: 200}", "N/m at the tip; less is softer"),
    "impedance": ("gains: {law: cartesian_impedance}", "or joint_impedance"),
    "admittance": ("gains: {law: admittance}", ""),
    "law": ("gains: {law: cartesian_impedance}", ""),
    "stop": ("mode: stop", ""),
    "hold": ("mode: hold", ""),
    "active": ("mode: active", ""),
    "acknowledge": ("mode: acknowledge", ""),
    "grasp": ("hand: {width_m: -0.02, force_N: 20}", "without force_N as hard as allowed"),
    "gripper": ("hand: {width_m: 0.05}", "m between the fingers"),
    "move": ("goal: {offset_m: [0, 0, 0.05]}", ""),
}
FARTHEST_M = 10.0  # of any goal; more are millimetres
LENGTHS = ("offset_m", "position_m", "circle_centre_m")


def meant(word: str) -> str:
    """The command that says so; empty if there is none."""
    entry, aside = MEANT.get(word.strip().lower().replace("-", "_"), ("", ""))
    return f"limber send '{entry}'" + (f" ({aside})" if aside else "") if entry else ""


def check_lengths(goal: dict[str, Any]) -> None:
    """Metres, not millimetres."""
    for key in LENGTHS:
        given = goal.get(key)
        numbers = given if isinstance(given, list | tuple) else []
        for number in numbers:
            if isinstance(number, int | float) and FARTHEST_M < abs(number) < math.inf:
                raise InputError(
                    f"{key}: {number:g} m is no arm's reach: lengths are in metres; if "
                    f"{number:g} mm is meant, write {number / 1000:g}"
                )


def check_entry(text: str, known: dict[str, list[str]]) -> None:
    """Of `limber send`, before it is sent: words that are none here, with what they mean, and
    lengths in millimetres. All else is limber-send's to judge. `known`: keys of entries, and of
    gains and laws.
    """
    try:
        entry = yaml.safe_load(text)
    except yaml.YAMLError:
        return
    if isinstance(entry, str):
        entry = {entry: None}
    if not isinstance(entry, dict):
        return
    for key in entry:
        _refuse_unknown(str(key), known["entries"], "a request")
    gains = entry.get("gains")
    for key in gains if isinstance(gains, dict) else ():
        _refuse_unknown(str(key), known["gains"], "a gain")
    if isinstance(entry.get("goal"), dict):
        check_lengths(entry["goal"])


def _refuse_unknown(word: str, known: list[str], what: str) -> None:
    if word not in known and meant(word):
        raise InputError(f"{word!r} is not {what} here; try: {meant(word)}")
