"""limber's C++ in programs of others: protocols, gate, kernel, and laws of their own."""

import re
import subprocess
import sys

import pytest
from local_drive import multicast_group

from limber.live import network
from limber.paths import ROOT

CLIENT = """
#include <cstdio>
#include "drivers/gate/torque_gate.h"
#include "drivers/protocols/mit.h"
#include "dynamics/arm_kernel.h"

int main() {
  using namespace limber;
  CanFrame frame;
  const mit::Command still{.kp_Nm_per_rad = 0.0};
  if (!mit::encode_command(still, CommandRange{}, 1, false, mit::Quantiser::kTruncate, &frame))
    return 1;
  TorqueGate gate(GateLimits{.n = 1, .session = 1});
  std::printf("%02X%02X %d\\n", frame.data[0], frame.data[1], gate.memory().state_seq == -1);
  dynamics::BodyChain chain;
  dynamics::Body body;
  body.mass.mass = 2.0;
  body.mass.com = {0.5, 0.0, 0.0};
  body.R << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // the axis lies
  chain.bodies = {body};
  chain.frames = {{0}};
  auto kernel = dynamics::arm_kernel(chain, {0.0, 0.0, -9.81});
  VectorJ g(1);
  kernel->place(VectorJ::Zero(1));
  kernel->gravity(&g, nullptr);
  std::printf("%.3f\\n", std::abs(g[0]));
}
"""
CMAKE = """
cmake_minimum_required(VERSION 3.22)
project(client LANGUAGES CXX)
find_package(limber REQUIRED)
add_executable(client client.cc)
target_link_libraries(client PRIVATE limber::protocols limber::gate limber::kernel)
"""


def run(*command: object, cwd=None) -> str:
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_find_package(installed, tmp_path):
    (tmp_path / "client.cc").write_text(CLIENT, encoding="utf-8")
    (tmp_path / "CMakeLists.txt").write_text(CMAKE, encoding="utf-8")
    folder = installed.call("limber", "--cmake-dir").stdout.strip()
    run("cmake", "-S", tmp_path, "-B", tmp_path / "build", f"-Dlimber_DIR={folder}")
    run("cmake", "--build", tmp_path / "build")
    assert run(tmp_path / "build" / "client").split() == ["7FFF", "1", "9.810"], (
        "the middle of the range; a gate that has accepted nothing; 2 kg at half a metre"
    )


SIMULATED = """
limber sim desktop2r >sim.txt 2>&1 &
for try in $(seq 100); do grep -q "realtime" sim.txt && break; sleep 0.1; done
"$@"; code=$?
kill %1; wait %1
exit $code
"""


@pytest.mark.parametrize("language", ["C++", "Python"])
def test_a_driver_of_ones_own(installed, language):
    """examples/own_driver, against the installed simulator, in a network of its own."""
    example = ROOT / "examples" / "own_driver"
    build = installed.cwd / "own_driver"
    if language == "C++":
        folder = installed.call("limber", "--cmake-dir").stdout.strip()
        run("cmake", "-S", example, "-B", build, f"-Dlimber_DIR={folder}")
        run("cmake", "--build", build)
        client = [str(build / "client")]
    else:
        client = [sys.executable, str(example / "client.py"), multicast_group("desktop2r")]
    inside = ["bash", "-mc", SIMULATED, "bash", *client]
    done = installed.call(*(network.private_command() or []), *inside)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.findall(r"motor (\d): ([+-][\d.]+) rad", done.stdout)
    assert [motor for motor, _ in found] == ["1", "2"] * 4
    assert all(abs(float(moved)) < 0.2 for _, moved in found), done.stdout


def test_every_public_header_needs_eigen_alone(installed, tmp_path):
    headers = installed.package / "include" / "limber"
    names = sorted(str(path.relative_to(headers)) for path in headers.rglob("*.h"))
    assert len(names) > 40
    source = tmp_path / "all.cc"
    source.write_text("".join(f'#include "{name}"\n' for name in names), encoding="utf-8")
    run("c++", "-std=c++20", "-fsyntax-only", "-I", headers, "-I/usr/include/eigen3", source)


@pytest.fixture(scope="session")
def law(installed):
    done = installed.call("limber", "law", "new", "my_law")
    assert done.returncode == 0, done.stderr
    return installed.cwd / "my_law"


def test_a_law_of_ones_own(installed, law):
    done = installed.call("limber", "law", "check", "my_law")
    assert done.returncode == 0, done.stdout + done.stderr
    for rule in ("no memory is allocated", "tau_damping takes power", "gradient of spring_energy"):
        (line,) = (line for line in done.stdout.splitlines() if rule in line)
        assert "ok in" in line
    (installed.cwd / "soft.yaml").write_text(
        "format: limber-scenario/1\nrobot: planar2r\nfriction: false\nduration_s: 4\n"
        "law_file: my_law/build/my_law.so\n"
        "timeline:\n"
        "  - {at_s: 0.3, mode: hold}\n"
        "  - {at_s: 0.8, mode: active}\n"
        "  - {at_s: 1.0, gains: {law: my_law, K_x_translation_N_per_m: 300}}\n"
        "  - {at_s: 1.5, push: {force_N: [0, 5, 0], ramp_s: 0.2, for_s: 2.4}}\n",
        encoding="utf-8",
    )
    ran = installed.call("limber", "lab", "soft.yaml", "--out", "soft")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    plotted = installed.call("limber", "plot", "soft")
    assert plotted.returncode == 0, plotted.stdout + plotted.stderr


def broken(law, tmp_path, old: str, new: str):
    folder = tmp_path / "my_law"
    folder.mkdir()
    for path in (law / "my_law.cc", law / "CMakeLists.txt"):
        (folder / path.name).write_text(path.read_text(encoding="utf-8").replace(old, new))
    return str(folder)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "const Eigen::Vector3d e =",
            "Eigen::VectorXd x(99); x.setZero(); const Eigen::Vector3d e =",
            "allocates memory",
        ),
        ("0.5 * e.dot", "0.7 * e.dot", "tau_stiffness pulls with"),
        ("= -in.gains.parameters", "= in.gains.parameters", "into the arm"),
        (
            "out->act_at_tip(in.terms.J, F_spring",
            "out->act_at_tip(in.terms.J, F_spring / 0.0",
            "not finite",
        ),
        (
            "const Eigen::Vector3d e =",
            'throw "no"; const Eigen::Vector3d e =',
            "threw an exception",
        ),
    ],
)
def test_a_wrong_law_is_found(installed, law, tmp_path, old, new, told):
    done = installed.call("limber", "law", "check", broken(law, tmp_path, old, new))
    assert done.returncode == 1 and told in done.stdout + done.stderr, done.stdout + done.stderr


def test_a_law_that_others_may_write_is_refused(installed, law, tmp_path):
    installed.call("limber", "law", "check", "my_law")
    file = law / "build" / "my_law.so"
    file.chmod(0o775)
    done = installed.call("limber-check", "law", str(file), PATH=str(installed.package / "bin"))
    file.chmod(0o755)
    assert done.returncode == 2 and "chmod go-w" in done.stderr


def test_a_law_of_another_version_is_refused(installed, law, tmp_path):
    folder = broken(
        law,
        tmp_path,
        "#include",
        "#include <limber/version.h>\n#undef LIMBER_VERSION\n"
        '#define LIMBER_VERSION "0.0.9"\n#include',
    )
    done = installed.call("limber", "law", "check", folder)
    assert done.returncode == 2 and "compiled for limber 0.0.9, and this is" in done.stderr
