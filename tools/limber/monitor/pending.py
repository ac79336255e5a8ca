"""Gains that the controller has taken and that no law runs with yet: in every mode but ACTIVE
CONTROLLER_STATUS carries those of the last law that ran.
"""

from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.messages import message_class
from limber.monitor.feed import Batch

ACTIVE = message_class("controller_status_t").MODE_ACTIVE
KIND_GAINS = message_class("request_answer_t").KIND_GAINS
BLOCKS = {"K_x_translation_N_per_m": slice(0, 3), "K_x_rotation_Nm_per_rad": slice(3, 6)}
ASKED = 200  # requests whose answer is still to come
MOST_LINES = 4  # the buttons stand below them
UNSEEN = "gains that another program has set and this page has not seen"
REPORTED = ("K_x_translation_N_per_m", "K_x_rotation_Nm_per_rad", "K_q_Nm_per_rad")
UNITS = dict(zip(REPORTED, ("N/m", "N m/rad", "N m/rad"), strict=True))


class Pending:
    """`values`: by key of the gains, what will be in effect; `law`: likewise, or empty."""

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self.law = ""
        self._unseen = False
        self._asked: dict[tuple[int, int], Any] = {}
        self._run = 0

    def note(self, batch: Batch, status: np.void | None) -> None:
        """Called with every batch of messages."""
        if status is not None and int(status["controller"]) != self._run:
            self._run = int(status["controller"])
            self._forget()
        for message in batch.objects.get("COMPLIANCE_GAINS", []):
            self._asked[message.client, message.seq] = message
        for answer in batch.objects.get("REQUEST_ANSWER", []):
            if answer.kind != KIND_GAINS:
                continue
            message = self._asked.pop((answer.client, answer.seq), None)
            if answer.accepted and message is None:
                self._unseen = True
            elif answer.accepted:
                self._take(message)
        while len(self._asked) > ASKED:
            self._asked.pop(next(iter(self._asked)))
        if status is not None and int(status["mode"]) == ACTIVE:
            self._forget()

    def _forget(self) -> None:
        self.values, self.law, self._unseen = {}, "", False

    def _take(self, message: Any) -> None:
        if message.law:
            self.law = message.law
        every = message.scope == message.SCOPE_ALL
        keys = list(REPORTED) if every else list(message.named)
        for key in keys:
            self.values[key] = _value(message, key)
        for parameter in message.parameters:
            self.values[parameter.key] = np.array(parameter.values)

    def words(self, status: np.void, law: str) -> list[str]:
        """One line each that differs from what is in effect, with both; `law`: the present one."""
        lines = [f"law: {self.law} (now {law})"] if self.law and self.law != law else []
        for key, value in self.values.items():
            now = in_effect(status, key)
            if value is None or now is None:
                lines.append(key if value is None else f"{key}: {several(value)}")
            elif not np.allclose(value, now, rtol=1e-3, atol=1e-6):
                lines.append(f"{key}: {several(value)} (now {several(now)})")
        if len(lines) > MOST_LINES:
            lines[MOST_LINES - 1 :] = [f"and {len(lines) - MOST_LINES + 1} more"]
        return [*lines, UNSEEN] if self._unseen else lines


def in_effect(status: np.void, key: str) -> np.ndarray | None:
    """As CONTROLLER_STATUS carries it; None if it does not."""
    if key in BLOCKS:
        return np.diag(status["K_x"])[BLOCKS[key]]
    if key == "K_q_Nm_per_rad":
        K_q: Floats = status["K_q"][: int(status["num_joints"])]
        return K_q
    return None


def several(value: Any) -> str:
    """300, or 333 / 222 / 111."""
    numbers = [f"{number:.4g}" for number in np.ravel(value)]
    return numbers[0] if len(set(numbers)) == 1 else " / ".join(numbers)


def _value(message: Any, key: str) -> Any:
    """None: it has no numbers of its own, such as a choice."""
    if key in BLOCKS:
        return np.diag(np.array(message.K_x))[BLOCKS[key]]
    field = next((f for f in message.__slots__ if key == f or key.startswith(f"{f}_")), None)
    value = getattr(message, field, None) if field else None
    if isinstance(value, float):
        return np.array(value)
    if isinstance(value, list | tuple) and field in ("K_q", "D_q", "K_null", "D_null"):
        return np.array(value[: message.num_joints])
    return None
