"""Where the key of a variation is in a scenario: dots lead inwards, numbers into lists.

`gains.K_q_Nm_per_rad` is that of the one entry `gains` in the timeline that has it, or of the only
entry; `payload.mass_kg` makes an entry at 0 s if there is none. `plant_overrides.joints.*.friction`
is every joint that has the next word in robot.yaml.
"""

from typing import Any

from limber.errors import InputError

ENTRIES = ("gains", "goal", "stream", "push", "wall", "hand", "payload", "fault")


def put(scenario: dict[str, Any], key: str, value: Any, joints: dict[str, Any]) -> None:
    """`joints`: of robot.yaml. Raises InputError if there is no such place; whether the scenario's
    reader knows the key is left to it.
    """
    words = key.split(".")
    if words[0] in ENTRIES:
        words = ["timeline", str(_entry(scenario, key, words)), *words]
    for way in _ways(words, key, joints):
        _set(scenario, way, value, key)


def _entry(scenario: dict[str, Any], key: str, words: list[str]) -> int:
    kind, inside = words[0], words[1] if len(words) > 1 else ""
    timeline = scenario.setdefault("timeline", [])
    of_kind = [row for row, entry in enumerate(timeline) if kind in entry]
    with_key = [row for row in of_kind if inside in (timeline[row][kind] or ())]
    found = with_key or of_kind
    if len(found) > 1:
        names = ", ".join(f"timeline.{row}.{key}" for row in found)
        raise InputError(f"{key}: the timeline has {len(found)} such entries; expected {names}")
    if found:
        return found[0]
    if kind != "payload":
        raise InputError(f"{key}: the timeline has no entry {kind}")
    timeline.append({"at_s": 0, kind: {}})
    return len(timeline) - 1


def _ways(words: list[str], key: str, joints: dict[str, Any]) -> list[list[str]]:
    if "*" not in words[:-1]:
        return [words]
    star = words.index("*")
    found = [name for name, joint in joints.items() if words[star + 1] in joint]
    if not found:
        raise InputError(f"{key}: no joint in robot.yaml has {words[star + 1]}")
    return [[*words[:star], name, *words[star + 1 :]] for name in found]


def _set(inside: Any, words: list[str], value: Any, key: str) -> None:
    place: Any = words[0]
    if isinstance(inside, list):
        if not (place.isdigit() and int(place) < len(inside)):
            last = len(inside) - 1
            raise InputError(f"{key}: '{place}' is no place in a list; expected 0 to {last}")
        place = int(place)
    if len(words) == 1:
        inside[place] = value
        return
    further = inside.get(place) if isinstance(inside, dict) else inside[place]
    if not isinstance(further, dict | list):
        inside[place] = further = {}
    _set(further, words[1:], value, key)
