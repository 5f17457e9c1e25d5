# SPDX-License-Identifier: BSD-3-Clause
"""Decks from nested dicts, for tests and performance programs."""

from xml.sax.saxutils import quoteattr

TYPES = {bool: "bool", int: "int", float: "double", str: "string"}


def text_of(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


def xml(name, tree):
    """A nested dict as a ParameterList; lists become arrays."""
    lines = [f"<ParameterList name={quoteattr(name)}>"]
    for key, value in tree.items():
        if isinstance(value, dict):
            lines.append(xml(key, value))
            continue
        kind = TYPES[type(value[0] if isinstance(value, list) else value)]
        if isinstance(value, list):
            kind = f"Array({kind})"
            value = "{" + ", ".join(map(text_of, value)) + "}"
        parameter = f"name={quoteattr(key)} type={quoteattr(kind)} value={quoteattr(text_of(value))}"
        lines.append(f"<Parameter {parameter}/>")
    return "\n".join([*lines, "</ParameterList>"])
