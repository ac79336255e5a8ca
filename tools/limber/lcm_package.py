"""LCM's Python package, for lcm-spy. Its wheel links GLib, which small systems lack."""

from typing import Any

from limber.errors import RunError
from limber.paths import command_for


def lcm_package() -> Any:
    """Loaded where it is used: nothing else needs it. Raises RunError."""
    try:
        import lcm
    except ImportError as error:
        cause = error.__context__ or error
        missing = getattr(cause, "name", None) == "lcm"
        cure = (missing and command_for("lcm")) or "sudo apt-get install libglib2.0-0"
        raise RunError(f"LCM cannot be loaded ({cause}): {cure}") from error
    return lcm
