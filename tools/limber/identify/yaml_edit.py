"""Changes numbers in YAML text and leaves all else as its author wrote it, comments included."""

from typing import Any

import yaml

from limber.errors import InputError

MARK = "identified"


def set_number(text: str, path: tuple[str, ...], value: str) -> str:
    """`text` with the number under `path`, which is added where a mapping on the way ends.

    A comment behind the number on its line is kept, with a note that it is about another number.
    """
    keys = list(path)
    node = yaml.compose(text)
    last = None
    while keys and isinstance(node, yaml.MappingNode):
        found = next((v for k, v in node.value if k.value == keys[0]), None)
        if found is None:
            return _add(text, node, keys, value)
        node, last = found, keys.pop(0)
    if keys or not isinstance(node, yaml.ScalarNode):
        raise InputError(f"{'.'.join(path)}: what is at {last} is not what was expected there")
    start, end = node.start_mark.index, node.end_mark.index
    return _note(text[:start] + value + text[end:], start + len(value))


def _add(text: str, node: yaml.MappingNode, keys: list[str], value: str) -> str:
    if node.flow_style:
        at = node.end_mark.index - 1
        separator = ", " if node.value else ""
        return _note(text[:at] + separator + _flow(keys, value) + text[at:], at)
    indent = " " * node.start_mark.column
    last = node.value[-1][1]
    at = _line_end(text, _content_end(last))
    entry = keys[0] + ": " + (value if len(keys) == 1 else "{" + _flow(keys[1:], value) + "}")
    return text[:at] + f"\n{indent}{entry} # {MARK}" + text[at:]


def _flow(keys: list[str], value: str) -> str:
    if len(keys) == 1:
        return f"{keys[0]}: {value}"
    return f"{keys[0]}: {{{_flow(keys[1:], value)}}}"


def _content_end(node: yaml.Node) -> int:
    """Where a node's last character is; a block's own end mark is where the next thing starts."""
    while isinstance(node, yaml.MappingNode | yaml.SequenceNode) and not node.flow_style:
        last = node.value[-1]
        node = last[1] if isinstance(last, tuple) else last
    return node.end_mark.index


def _line_end(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end == -1 else end


def _note(text: str, at: int) -> str:
    end = _line_end(text, at)
    before, mark, comment = text[at:end].partition(" #")
    comment = comment.strip()
    if comment.startswith(MARK):
        return text
    was = f"; before: {comment}" if mark else ""
    return text[:at] + before.rstrip() + f" # {MARK}{was}" + text[end:]


def fragment(changes: dict[tuple[str, ...], Any]) -> str:
    """The changed numbers alone, as YAML."""
    tree: dict[str, Any] = {}
    for path, value in changes.items():
        level = tree
        for key in path[:-1]:
            level = level.setdefault(key, {})
        level[path[-1]] = value
    return yaml.safe_dump(tree, sort_keys=False)
