"""The words of `limber send`, from the controller's own list."""

from limber.live.meant import check_entry
from limber.model.gains_table import listing

ENTRIES = ("mode", "gains", "goal", "hand", "push", "wall", "payload", "fault")


def check_entries(entries: list[str]) -> None:
    """InputError for a word that means something else here, and for lengths in millimetres."""
    if not entries:
        return
    found = listing()
    gains = [row["key"] for row in found["gains"]]
    gains += [row["key"] for law in found["laws"] for row in law["parameters"]]
    known = {"entries": list(ENTRIES), "gains": ["law", *gains]}
    for entry in entries:
        check_entry(entry, known)
