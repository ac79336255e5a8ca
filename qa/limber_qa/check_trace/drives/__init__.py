"""Frames of each drive family, read by its maker's manual; modules are named as the protocols.

Each has `commands(motor, trace)`, `states(motor, trace)`, `resolution_Nm(motor)`, and TELLS_HOLD:
whether a command shows that the drive holds by gains of its own.
"""

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from limber.errors import InputError


def decoder(protocol: str) -> ModuleType:
    """Raises InputError for a protocol that has none."""
    names = [module.name for module in iter_modules(__path__)]
    if protocol not in names:
        raise InputError(f"the trace checker cannot read '{protocol}'; it reads {', '.join(names)}")
    return import_module(f"{__name__}.{protocol}")
