"""Without the extra the command names it."""

import subprocess
import sys

WITHOUT = "import sys; sys.modules['cyclonedds'] = None; sys.argv = ['limber', 'ros2']; import {}"


def test_the_package_is_named_with_the_command_that_installs_it():
    program = WITHOUT.format("limber.cli.main as program; program.main()")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 3
    assert done.stderr.startswith("limber: this needs the package cyclonedds")
    assert "pip install" in done.stderr and "[ros2]" in done.stderr
    assert "Traceback" not in done.stderr
