# SPDX-License-Identifier: BSD-3-Clause
"""The functions of a C++ source, found by its braces alone."""

import re

TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|[{};]', re.DOTALL
)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
DIRECTIVE = re.compile(r"^\s*#(?:.*\\\n)*.*$", re.MULTILINE)
# What opens a scope in which functions are defined, at the end of what stands before the brace.
SCOPE = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b[^()]*$")
# A member's or a base's braces in the list of a constructor: C(int a) : Base<int>{a}, a_{a}
MEMBER = re.compile(r"\)\s*(?:noexcept\s*)?:(?!:).*[\w>]$")


def without_template(head):
    """A head without the parameters of its template, which may themselves be classes."""
    if not head.startswith("template"):
        return head
    depth = 0
    for place, letter in enumerate(head):
        depth += (letter == "<") - (letter == ">")
        if letter == ">" and depth == 0:
            return without_template(head[place + 1 :].lstrip())
    return head


def kind_of(head, stack):
    """What a brace after `head` opens: a scope, a function, or a block of something else."""
    if any(kind != "scope" for kind, *_ in stack):
        return "block"
    if head.count("(") > head.count(")") or MEMBER.search(head):
        return "block"  # an argument, or what a constructor begins with
    if SCOPE.search(without_template(head)):
        return "scope"
    return "function" if re.search(r"[\])]", head) else "block"


def functions(text):
    """(first line, last line, head) of every body, that of a lambda which a namespace or a class names
    too; those within functions are left out.

    Raises ValueError where braces do not close: the source is none, or this parser is wrong."""
    text = DIRECTIVE.sub(lambda match: "\n" * match.group().count("\n"), text)
    stack, found, last = [], [], 0
    for match in TOKEN.finditer(text):
        token = match.group()
        if token not in "{};":
            continue
        line = text.count("\n", 0, match.start()) + 1
        if token == "{":
            head = " ".join(COMMENT.sub("", text[last : match.start()]).split())
            stack.append((kind_of(head, stack), line, head, last))
        elif token == "}":
            if not stack:
                raise ValueError(f"line {line}: a brace closes nothing")
            kind, first, head, before = stack.pop()
            if kind == "function":
                found.append((first, line, head))
            elif kind == "block":  # what is being defined goes on
                last = before
                continue
        last = match.end()
    if stack:
        raise ValueError(f"line {stack[-1][1]}: a brace is not closed")
    return found
