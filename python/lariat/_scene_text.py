"""A scene, or an experiment, in a dict, as the YAML that the library reads."""

import json
import math
import os
import re

from ._lariat import ArgumentError


def _tidy(value, where):
    """The value with numpy's scalars, arrays and paths as json knows them. What a file could not
    say is refused, with the key at which it stands."""
    if value is None:
        raise ArgumentError(f"{where}: None is no value; leave the key out")
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ArgumentError(f"{where}: {value} is not a finite number")
        return value
    if isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, dict):
        return {key: _tidy(one, f"{where}.{key}") for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_tidy(one, f"{where}[{i}]") for i, one in enumerate(value)]
    if hasattr(value, "tolist"):
        return _tidy(value.tolist(), where)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{where}: a value of {type(value)!r} is nothing that scenes have")


def text_of(value, name):
    """A dict as YAML. In files `all` is a word and "all" in quotes the name of a set; who writes a
    dict means the word."""
    try:  # libyaml knows no pairs of surrogates, so characters stay themselves
        text = json.dumps(_tidy(value, name), ensure_ascii=False, indent=1)
    except (ValueError, RecursionError) as error:
        if isinstance(error, ArgumentError):
            raise
        raise ArgumentError(f"{name}: {error}") from None
    return re.sub(r'(?<!\\)"all"(?!:)', "all", text)
