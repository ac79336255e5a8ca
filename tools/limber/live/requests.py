"""Requests to the controller, each answered by REQUEST_ANSWER."""

import threading
import time
import warnings
from typing import Any

from limber import messages
from limber.live.arm_errors import RefusedError, StackLostError
from limber.live.script_client import script_client
from limber.live.stack_link import StackLink
from limber.live.way import in_words_of
from limber.problems import problem

ANSWER_S = 5.0  # for a machine that is busy
CHANNELS = {
    "mode_request_t": "MODE_REQUEST",
    "compliance_goal_t": "COMPLIANCE_GOAL",
    "compliance_gains_t": "COMPLIANCE_GAINS",
    "target_stream_t": "TARGET_STREAM",
    "torque_overlay_t": "TORQUE_OVERLAY",
    "hand_goal_t": "HAND_GOAL",
    "push_t": "PUSH",
    "scenario_event_t": "SCENARIO_EVENT",
}


class RequestPort:
    """One client of the controller. `client`: number of its lease. From any thread."""

    def __init__(self, link: StackLink, client: int | None = None) -> None:
        self.client = script_client() if client is None else client
        self._link = link
        self._answers = link.receiver.stream("REQUEST_ANSWER")
        self._turn = threading.Lock()  # one request at a time waits for its answer
        self._leaving = threading.Lock()  # messages leave in the order of their seq
        self._seq = 0

    def send(self, message: Any, timeout_s: float = ANSWER_S) -> Any:
        """Returns the answer; RefusedError with its reason, or StackLostError if none comes."""
        with self._turn:
            self._answers.raw()
            self._publish(message)
            message_seq, end_s = message.seq, time.monotonic() + timeout_s
            while (left_s := end_s - time.monotonic()) > 0 and self._answers.wait(left_s):
                for data in self._answers.raw():
                    answer = _answer(data)
                    if answer and (answer.client, answer.seq) == (self.client, message_seq):
                        return _accepted(answer, self._link)
        raise StackLostError(
            f"the controller has not answered a request within {timeout_s:g} s: see whether "
            "limber-controller and limber-driver still run"
        )

    def stream(self, message: Any) -> None:
        """Sends what is answered only where it is refused: RefusedError, by the next call.

        Does not wait while another thread's request does: a refusal of then is told later.
        """
        waiting: list[bytes] = []
        if self._turn.acquire(blocking=False):
            waiting = self._answers.raw()
            self._turn.release()
        self._publish(message)
        for data in waiting:
            answer = _answer(data)
            if answer and answer.client == self.client and not answer.accepted:
                _accepted(answer, self._link)

    def post(self, message: Any) -> None:
        """Sends to the simulator, which answers nothing."""
        self._publish(message)

    def _publish(self, message: Any) -> None:
        # Greater than that of any sender with this client's number before.
        self._link.check()
        with self._leaving:
            self._seq = max(self._seq + 1, time.monotonic_ns())
            message.seq, message.time_ns = self._seq, time.monotonic_ns()
            if hasattr(message, "client"):
                message.client = self.client
                message.controller = int(self._link.records()[1]["controller"])
            self._link.receiver.publish(CHANNELS[type(message).__name__], message)


def _answer(data: bytes) -> Any:
    try:
        return messages.decode("request_answer_t", data)
    except ValueError:
        return None


def _accepted(answer: Any, link: StackLink) -> Any:
    if answer.accepted:
        if answer.reason:
            warnings.warn(f"taken, but: {answer.reason}", stacklevel=5)
        return answer
    cause = problem("request", answer.code)
    if cause is None:
        raise RefusedError("request", answer.reason)
    if answer.code == answer.REFUSED_MODE:
        mode = int(link.records()[1]["mode"])
        words = in_words_of(answer, messages.constants("controller_status_t", "MODE_")[mode])
        raise RefusedError(cause.code, words)
    raise RefusedError(cause.code, answer.reason, cause.remedy)
