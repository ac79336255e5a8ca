"""The jar of `limber log spy`, by the class through which lcm-spy finds and decodes types."""

import shutil
import subprocess

import pytest

from limber import messages
from limber.errors import RunError
from limber.live import spy

DECODE = """
import java.nio.file.*;

public class Decode {
    public static void main(String[] names) throws Exception {
        var database = new lcm.spy.LCMTypeDatabase();
        for (String name : names) {
            var input = new lcm.lcm.LCMDataInputStream(Files.readAllBytes(Path.of(name)));
            long fingerprint = input.readLong();
            input.reset();
            Class<?> type = database.getClassByFingerprint(fingerprint);
            var decoded = type.getConstructor(java.io.DataInput.class).newInstance(input);
            Object time = type.getField("time_ns").get(decoded);
            System.out.println("decoded " + type.getName() + " " + time);
        }
    }
}
"""


@pytest.mark.skipif(shutil.which("javac") is None, reason="no Java compiler")
def test_every_type_is_found_and_decoded(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    jar = spy.types_jar()
    assert spy.types_jar() == jar, "not built again"
    (tmp_path / "Decode.java").write_text(DECODE)
    names = sorted({row.type_name for row in messages.channels().values()})
    for number, name in enumerate(names):
        message = messages.message_class(name)()
        message.time_ns = 1000 + number
        (tmp_path / name).write_bytes(message.encode())
    command = ["java", "-cp", f"{jar}:{spy.lcm_jar()}", "Decode.java", *names]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    decoded = [line for line in done.stdout.splitlines() if line.startswith("decoded")]
    assert decoded == [f"decoded limber.{name} {1000 + n}" for n, name in enumerate(names)]


def test_without_java_it_says_what_to_install(monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(RunError, match=r"`java` is not installed: .*default-jdk"):
        spy.start()


def test_without_windows_or_a_display_it_says_so(monkeypatch, tmp_path):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr(spy, "types_jar", lambda: tmp_path / "types.jar")
    java = tmp_path / "jvm" / "bin" / "java"
    monkeypatch.setattr(spy, "_program", lambda _name: str(java))
    with pytest.raises(RunError, match="has none: sudo apt-get install default-jdk"):
        spy.start()
    (tmp_path / "jvm" / "lib").mkdir(parents=True)
    (tmp_path / "jvm" / "lib" / "libawt_xawt.so").touch()
    with pytest.raises(RunError, match="needs a display"):
        spy.start()
