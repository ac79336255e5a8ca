"""XML as limber-check judges it: the same parser, UTF-8 whatever is declared, prefixes as part of a
name.
"""

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from limber.arrays import Floats
from limber.errors import InputError
from limber.model.rotations import matrix_of, turned_about


def read_xml(path: Path, comments: bool = False) -> Element:
    """The root. Attributes and elements with a prefix keep it: "drake:acceleration"; nobody has to
    declare it. `comments`: keep them, too. Raises InputError.
    """
    builder = TreeBuilder(insert_comments=comments)
    parser = expat.ParserCreate("utf-8")  # not the declared encoding
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    parser.CommentHandler = builder.comment
    try:
        parser.Parse(path.read_bytes(), True)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except expat.ExpatError as error:
        problem = expat.ErrorString(error.code)
        raise InputError(
            f"{path}:{error.lineno}: cannot be read as URDF: not well-formed XML: {problem}"
        ) from error
    return builder.close()


def inside(element: Element, tag: str, path: Path) -> Element:
    """The first element with this tag in `element`, a named one of the file. Raises InputError."""
    found = element.find(tag)
    if found is None:
        raise InputError(f"{path}: {_words(element)} has no <{tag}>")
    return found


def attribute(element: Element, key: str, path: Path) -> str:
    """Raises InputError if it is absent."""
    value = element.get(key)
    if value is None:
        raise InputError(f'{path}: {_words(element)} has no {key}=""')
    return value


def numbers_of(element: Element | None, key: str, default: str) -> Floats:
    text = element.get(key, default) if element is not None else default
    return np.array([float(part) for part in text.split()])


def origin_pose(parent: Element) -> Floats:
    """4x4, of the <origin> in it: rpy turns by roll about x, then pitch about y, then yaw about z,
    all of the parent's axes; quat_xyzw, of URDF 1.1, stands in its place.
    """
    X, origin = np.eye(4), parent.find("origin")
    X[:3, 3] = numbers_of(origin, "xyz", "0 0 0")
    if origin is not None and origin.get("quat_xyzw") is not None:
        X[:3, :3] = matrix_of(np.roll(numbers_of(origin, "quat_xyzw", ""), 1))
    else:
        roll, pitch, yaw = np.diag(numbers_of(origin, "rpy", "0 0 0"))
        X[:3, :3] = turned_about(yaw) @ turned_about(pitch) @ turned_about(roll)
    return X


def _words(element: Element) -> str:
    name = element.get("name")
    return f"a <{element.tag}>" if name is None else f'<{element.tag} name="{name}">'
