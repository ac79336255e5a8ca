"""Evaluates the controller's own classes through the program limber-eval."""

import json
import subprocess
from typing import Any

import numpy as np

from limber.errors import RunError
from limber.paths import captured, program

TIMEOUT_S = 300.0


def case(law: str, robot: str = "", **inputs: Any) -> dict[str, Any]:
    """One case: the law by its name, the robot's name where it needs one, SI units."""
    arm = {"robot": robot} if robot else {}
    return {"law": law, **arm, "in": plain(inputs)}


def evaluate(cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The results in the order of the cases; lists of numbers as arrays."""
    text = json.dumps(cases, allow_nan=False)
    command = [str(program("limber-eval"))]
    try:
        done = captured(command, input=text, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired as error:
        raise RunError(f"limber-eval gave no answer in {TIMEOUT_S:g} s") from error
    if done.returncode != 0:
        last = (done.stderr.strip() or "nothing").splitlines()[-1]
        raise RunError(f"limber-eval ended with code {done.returncode}: {last}")
    answers = json.loads(done.stdout)
    if len(answers) != len(cases):
        raise RunError(f"limber-eval gave {len(answers)} results for {len(cases)} cases")
    return [_arrays(answer, case["law"]) for answer, case in zip(answers, cases, strict=True)]


def plain(content: Any) -> Any:
    """The same for JSON and YAML: lists and numbers instead of numpy's."""
    return json.loads(json.dumps(content, default=lambda value: value.tolist()))


def _arrays(answer: dict[str, Any], law: str) -> dict[str, Any]:
    if "error" in answer:
        raise RunError(f"limber-eval, {law}: {answer['error']}")
    return {
        key: np.asarray(value) if isinstance(value, list) else value
        for key, value in answer.items()
    }
