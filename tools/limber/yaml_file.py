"""YAML files that no C++ program reads for us: tables of columns, and texts that are edited."""

from pathlib import Path
from typing import Any

import yaml

from limber.errors import InputError

# libyaml reads several times faster; a PyYAML built from source may lack it.
SAFE_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path) -> dict[str, Any]:
    try:
        with open(path, encoding="utf-8") as file:
            content = yaml.load(file, SAFE_LOADER)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a table of keys and values")
    return content
