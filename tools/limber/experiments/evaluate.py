"""Asks the controller's own classes for numbers, through the program limber-eval."""

import json
import subprocess
from typing import Any

import numpy as np

from limber.errors import RunError
from limber.paths import program

TIMEOUT_S = 300.0


def case(law: str, robot: str = "", **inputs: Any) -> dict[str, Any]:
    """One question: the law by its name, the robot's name where it needs one, SI units."""
    arm = {"robot": robot} if robot else {}
    return {"law": law, **arm, "in": {key: _plain(value) for key, value in inputs.items()}}


def evaluate(cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The answers in the order of the questions; lists of numbers as arrays."""
    text = json.dumps(cases, allow_nan=False)
    command = [str(program("limber-eval"))]
    try:
        done = subprocess.run(
            command, input=text, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"limber-eval gave no answer in {TIMEOUT_S:g} s") from error
    if done.returncode != 0:
        said = (done.stderr.strip() or "nothing").splitlines()[-1]
        raise RunError(f"limber-eval ended with code {done.returncode}: {said}")
    answers = json.loads(done.stdout)
    if len(answers) != len(cases):
        raise RunError(f"limber-eval answered {len(answers)} of {len(cases)} questions")
    return [_arrays(answer, asked["law"]) for answer, asked in zip(answers, cases, strict=True)]


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def _arrays(answer: dict[str, Any], law: str) -> dict[str, Any]:
    if "error" in answer:
        raise RunError(f"limber-eval, {law}: {answer['error']}")
    return {
        key: np.asarray(value) if isinstance(value, list) else value
        for key, value in answer.items()
    }
