"""Requests of the page to the arm, and what became of them. Nothing here waits for an answer."""

import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from limber import messages
from limber.errors import InputError
from limber.live import gains_message, request_messages
from limber.live.way import in_words_of
from limber.monitor.feed import Batch
from limber.monitor.live_feed import LiveFeed
from limber.monitor.words import mode_of
from limber.problems import problem, sentence

UNANSWERED_S = 0.5
STOP_AGAIN_S = 0.04
STOP_TRIES = 8
PUSH_ID = 9001
MODE = messages.message_class("mode_request_t")
ANSWER = messages.message_class("request_answer_t")
KIND_MODE = ANSWER.KIND_MODE


@dataclass(frozen=True)
class Outcome:
    """`text` is empty if the request was taken."""

    kind: str  # mode, goal, gains, hand
    text: str = ""


class Requests:
    """One lease on the arm, `client`. Requests come from the server's thread and from the drawing
    loop; `collect` is called with every batch of messages.
    """

    def __init__(self, feed: LiveFeed, client: int) -> None:
        self._feed, self.client = feed, client
        self._lock = threading.Lock()
        self._seq = 0
        self._open: dict[int, tuple[str, float]] = {}
        self._wrong: list[Outcome] = []  # never sent
        self._leased = False
        self._stop_sent_s, self._stop_tries = 0.0, 0  # tries: 0 when none is under way
        self.stops, self.stop_state = 0, ""

    def stop(self) -> None:
        """Needs no lease; repeated until it is answered. `stop_state`: what became of it."""
        with self._lock:
            self.stops, self.stop_state, self._stop_tries = self.stops + 1, "sent", 1
            self._stop_sent_s = time.monotonic()
        self._mode(MODE.REQUEST_STOP)

    def mode(self, word: str) -> None:
        """idle, hold, active, acknowledge or release."""
        self._expect("mode", self._mode(getattr(MODE, f"REQUEST_{word.upper()}")))

    def goal(self, p_BD: np.ndarray, quat_BD: np.ndarray) -> None:
        """At the controller's default speed; base frame, m; unit quaternion w, x, y, z."""
        message = request_messages.goal(
            self._joints(), position_m=p_BD, quaternion_wxyz=quat_BD, duration_s=0.0
        )
        self._expect("goal", self._send("COMPLIANCE_GOAL", message))

    def gains(self, values: dict[str, Any], ramp_s: float) -> None:
        """Law, numbers and choices by key; what is not named stays as it is."""
        numbers = {key: value for key, value in values.items() if key != "law"}
        try:
            message = gains_message.gains(self._joints(), values.get("law"), ramp_s, **numbers)
        except InputError as error:
            self._wrong.append(Outcome("gains", str(error)))
            return
        self._expect("gains", self._send("COMPLIANCE_GAINS", message))

    def hand(self, width_m: float, force_N: float) -> None:
        """As fast as robot.yaml allows."""
        message = messages.message_class("hand_goal_t")()
        message.width_m, message.force_N = width_m, force_N
        self._expect("hand", self._send("HAND_GOAL", message))

    def push(self, link: str, wrench: np.ndarray, duration_s: float) -> None:
        """On the simulated arm: base axes, N and N m, at the link's origin; replaces the last."""
        self._send(
            "PUSH",
            request_messages.push(wrench[:3], wrench[3:], duration_s, 0.0, link, PUSH_ID),
        )

    def collect(self, batch: Batch) -> list[Outcome]:
        """What was answered, refused or not answered since the last call."""
        now = time.monotonic()
        found, self._wrong = self._wrong, []
        kinds = messages.constants("request_answer_t", "KIND_")
        for answer in batch.objects.get("REQUEST_ANSWER", []):
            if answer.client == self.client:
                found.append(self._answered(answer, kinds.get(answer.kind, "REQUEST").lower()))
        late = [seq for seq, (_, sent_s) in list(self._open.items()) if now - sent_s > UNANSWERED_S]
        found += [Outcome(self._open.pop(seq)[0], "no controller answers") for seq in late]
        self._repeat_stop(now)
        return found

    def _answered(self, answer: Any, kind: str) -> Outcome:
        self._open.pop(answer.seq, None)
        stopped = answer.kind == KIND_MODE and answer.what == MODE.REQUEST_STOP
        if answer.accepted and stopped:
            self._stop_tries, self.stop_state = 0, "taken by the controller"
        elif answer.accepted:
            released = answer.kind == KIND_MODE and answer.what == MODE.REQUEST_RELEASE
            self._leased = not released
        return Outcome(kind, "" if answer.accepted else self._refusal(answer))

    def _refusal(self, answer: Any) -> str:
        """A request that does not fit the mode is named, with the mode and the way there."""
        if answer.code == ANSWER.REFUSED_MODE:
            return f"request.MODE: {in_words_of(answer, mode_of(self._feed) or 'this mode')}."
        return _refusal(answer.code, answer.reason)

    def _repeat_stop(self, now: float) -> None:
        with self._lock:
            if self._stop_tries == 0 or now - self._stop_sent_s < STOP_AGAIN_S:
                return
            if self._stop_tries >= STOP_TRIES:
                self._stop_tries, self.stop_state = 0, "NOT CONFIRMED: no controller answers"
                return
            self._stop_tries, self._stop_sent_s = self._stop_tries + 1, now
        self._mode(MODE.REQUEST_STOP)

    def _mode(self, request: int) -> int:
        message = MODE()
        message.request = request
        return self._send("MODE_REQUEST", message)

    def _send(self, channel: str, message: Any) -> int:
        """Returns its number."""
        with self._lock:
            self._seq = max(self._seq + 1, time.monotonic_ns())
            message.seq = message.time_ns = self._seq
            if hasattr(message, "client"):
                status = self._feed.newest.get("CONTROLLER_STATUS")
                message.controller = 0 if status is None else int(status["controller"])
                message.client = self.client
            self._feed.receiver.publish(channel, message)
        seq: int = message.seq
        return seq

    def _joints(self) -> int:
        status = self._feed.newest.get("CONTROLLER_STATUS")
        return 0 if status is None else int(status["num_joints"])

    def _expect(self, kind: str, seq: int) -> None:
        self._open[seq] = (kind, time.monotonic())

    def close(self) -> None:
        """Gives the lease back, if it has it."""
        if self._leased:
            self._mode(MODE.REQUEST_RELEASE)


def _refusal(code: int, reason: str) -> str:
    cause = problem("request", code)
    if cause is None:
        return reason
    return f"{cause.code}: {reason or cause.what}. {sentence(cause.remedy)}"
