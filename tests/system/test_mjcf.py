"""One run in limber's lab and in MuJoCo: an arm that falls softly from rest, driven by the same
motor torques."""

import subprocess

import numpy as np
import pytest

from limber.export import mjcf
from limber.log.reader import Log
from limber.model.robot import load_robot
from stack import BIN

pytestmark = pytest.mark.lockstep

FALL_S, LONG_S = 3.0, 0.9
FALL = f"""format: limber-scenario/1
name: fall
robot: openarm
mode: lockstep
integrator: reference
duration_s: 4.0
timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: 1.0, gains: {{law: joint_pd, ramp_s: 0.2}}}}
  - {{at_s: 1.5, goal: {{joints_rad: [0.4, 0.3, 0.3, 1.2, 0.3, 0.3, 0.3], duration_s: 1.0}}}}
  - {{at_s: {FALL_S}, gains: {{K_q_Nm_per_rad: 0.5, model_compensation: none, ramp_s: 0.2}}}}
"""


def test_a_fall(tmp_path):
    """Joints turn by up to 0.8 rad and stay within 10 mrad of each other; what differs is friction
    at rest, which MuJoCo's slips a little and limber's bristles hold.
    """
    mujoco = pytest.importorskip("mujoco")
    (tmp_path / "fall.yaml").write_text(FALL)
    log = tmp_path / "run.lcmlog"
    command = [str(BIN / "limber-lab"), str(tmp_path / "fall.yaml"), "--log", str(log)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    model = mujoco.MjModel.from_xml_string(mjcf.text(load_robot("openarm")))
    data, n = mujoco.MjData(model), model.nv
    truth = Log(log).read("SIM_TRUTH")
    time_s = (truth["time_ns"] - truth["time_ns"][0]) * 1e-9
    first, last = np.searchsorted(time_s, [FALL_S, FALL_S + LONG_S])
    data.qpos[:], data.qvel[:] = truth["q"][first, :n], truth["v"][first, :n]
    off = []
    for k in range(first + 1, last + 1):
        data.ctrl[:] = truth["tau_motor"][k, :n]
        mujoco.mj_step(model, data)
        off.append(np.abs(data.qpos - truth["q"][k, :n]).max())
    assert np.ptp(truth["q"][first : last + 1, :n], axis=0).max() > 0.7
    assert max(off) < 0.01
