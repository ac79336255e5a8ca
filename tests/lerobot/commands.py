"""LeRobot's commands, and simulated arms for them."""

import os
import sys
import time
from contextlib import contextmanager

from processes import started

from limber import Arm, NoStackError
from limber.paths import ROOT

ARM = "openarm_right"  # with a hand
OTHER = {
    "LCM_DEFAULT_URL": "udpm://239.255.76.67:7669?ttl=0",
    "LIMBER_ARM_URL": "udpm://239.255.76.68:7670?ttl=0",
}
FOLLOWER = ["--robot.type=limber_follower", f"--robot.arm={ARM}"]
LONGEST_S = 300


@contextmanager
def ended(command, **options):
    """A program that does not end by itself."""
    with started(command, **options) as process:
        yield process
        process.terminate()


@contextmanager
def stack(folder, **address):
    """The simulated arm, active and free for whoever asks, read by the Arm that is given."""
    folder.mkdir()
    scenario = folder / "waits.yaml"
    ready = (ROOT / "scenarios" / "ready.yaml").read_text(encoding="utf-8")
    scenario.write_text(ready.replace("robot: openarm", f"robot: {ARM}"), encoding="utf-8")
    run = [sys.executable, "-m", "limber", "run", scenario, "--one-process", "--no-record"]
    run += ["--out", folder / "run"]
    url = address.get("LCM_DEFAULT_URL")
    with ended(run, env={**os.environ, **address}), _found(url) as arm:
        arm.wait(until=lambda now: now.time_s > 2.0, timeout_s=60)  # released by then
        yield arm


def _found(url):
    end = time.monotonic() + 60.0
    while True:
        try:
            return Arm(ARM, url=url)
        except NoStackError:
            assert time.monotonic() < end, "no stack"
            time.sleep(1.0)


def environment(home, *paths):
    return {
        **os.environ,
        "CAN_CONFIG": '{"hop_limit": 0}',
        "HF_HUB_OFFLINE": "1",
        "HF_LEROBOT_HOME": str(home),
        "PYTHONPATH": os.pathsep.join(map(str, (ROOT / "tools", *paths))),
    }


def lerobot(python, home, *words, paths=(), meanwhile=lambda: time.sleep(0.1)):
    """Its output. `words`: a command of LeRobot's, or what Python takes; while it runs, `meanwhile`
    is called again and again. To a question the answer is Enter.
    """
    first, *rest = map(str, words)
    program = [python.with_name(first)] if first.startswith("lerobot-") else [python, first]
    told, enter = home / f"{time.monotonic_ns()}.txt", home / "enter"
    enter.write_text("\n", encoding="utf-8")
    with told.open("w", encoding="utf-8") as file, enter.open(encoding="utf-8") as answers:
        command = [*program, *rest]
        options = {"env": environment(home, *paths), "cwd": home, "stdin": answers}
        with started(command, **options, stdout=file, stderr=file) as process:
            end = time.monotonic() + LONGEST_S
            while process.poll() is None:
                assert time.monotonic() < end, told.read_text("utf-8")[-2000:]
                meanwhile()
    text = told.read_text("utf-8")
    assert process.returncode == 0, text[-3000:]
    return text
