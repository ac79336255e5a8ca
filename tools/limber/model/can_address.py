"""How CAN buses are addressed, as in common/can_address.h."""

KINDS = ("socketcan:", "virtual:", "slcan:", "dmserial:")


def full_address(bus: str) -> str:
    """A bare name, can0, is an interface of the kernel's."""
    return bus if ":" in bus else f"socketcan:{bus}"
