#!/usr/bin/env python3
"""Writes python/raio/_render_options.py: the options of the command line as types of keyword arguments.

`./check python` compares the file with what this prints.
"""

import textwrap

from raio._options import table, with_keywords

TYPES = {
    "switch": "bool",
    "integer": "int",
    "number": "float",
    "vector": "npt.ArrayLike",
    "color": "str | npt.ArrayLike",
    "size": "tuple[int, int] | str",
    "list": "str | Sequence[str] | Sequence[float]",
    "text": "str | int",
}


def type_of(option):
    if option["value_name"] == "FILE":
        return "str | os.PathLike[str]"
    words = "Literal[" + ", ".join(f'"{word}"' for word in option["words"]) + "]"
    if option["type"] == "number" and option["words"]:
        return "float | " + words
    if option["type"] != "words":
        return TYPES[option["type"]]
    return words + " | bool" if "on" in option["words"] else words


def member(keyword, option):
    one = f"    {keyword}: {type_of(option)} | None"
    if len(one) <= 110:
        return one
    words = textwrap.wrap(type_of(option)[8:-1], 100)
    return "\n".join([f"    {keyword}: Literal[", *(f"        {w}" for w in words), "    ] | None"])


def described(keyword, option):
    return textwrap.fill(f"{keyword}: {with_keywords(option['help'])}", 106, initial_indent=" " * 8,
                         subsequent_indent=" " * 12)


def class_text(name, base, doc, options):
    about = "\n".join(described(k, o) for k, o in options.items())
    members = "\n".join(member(k, o) for k, o in options.items())
    return (f'class {name}({base}, total=False):\n    """{doc}\n\n    Attributes:\n{about}\n    """\n\n'
            f"{members}")


def text():
    options = table()
    read = {k: o for k, o in options.items() if o["of_reader"]}
    others = {k: o for k, o in options.items() if not o["of_reader"]}
    return "\n\n\n".join([
        '"""The options of the command line as types of keyword arguments; by tools/python_options.py."""'
        "\n\nimport os\nfrom collections.abc import Sequence\nfrom typing import Literal, TypedDict"
        "\n\nimport numpy.typing as npt\n\nfrom ._annotations import AnnotationOptions",
        class_text("ReadOptions", "TypedDict", "How raio.load() reads a file. None: the default.", read),
        class_text("RenderOptions", "AnnotationOptions",
                   "How Scene.render() makes a picture. None: the default.", others),
        'class FileOptions(ReadOptions, RenderOptions):\n    """Both, for raio.render()."""',
    ]) + "\n"


if __name__ == "__main__":
    print(text(), end="")
