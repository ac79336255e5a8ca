"""A URDF with other masses and centres of mass; all else as it was, comments included."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from limber.model.xml_file import attribute, inside, read_xml

DIGITS = 5


def with_inertials(urdf: Path, changes: dict[str, tuple[float, np.ndarray]]) -> str:
    """`changes`: link -> mass, kg, and centre of mass in its own frame, m. Without any it is the
    file that a changed one is to be compared with.
    """
    root = read_xml(urdf, comments=True)
    for link in root.findall("link"):
        name = attribute(link, "name", urdf)
        if name not in changes:
            continue
        mass, com = changes[name]
        inertial = inside(link, "inertial", urdf)
        inside(inertial, "mass", urdf).set("value", f"{mass:.{DIGITS}g}")
        origin = inertial.find("origin")
        if origin is None:
            origin = ElementTree.SubElement(inertial, "origin")
        origin.set("xyz", " ".join(f"{x:.{DIGITS}g}" for x in com))
    return ElementTree.tostring(root, encoding="unicode") + "\n"
