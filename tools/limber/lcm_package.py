"""LCM's Python package. Its wheel links the system's GLib, which small systems lack."""

from typing import Any

from limber.errors import RunError


def lcm_package() -> Any:
    """Loaded where it is used: a demo or a lab run needs none of it. Raises RunError."""
    try:
        import lcm
    except ImportError as error:
        cause = error.__context__ or error
        raise RunError(
            f"LCM cannot be loaded ({cause}): sudo apt-get install libglib2.0-0"
        ) from error
    return lcm
