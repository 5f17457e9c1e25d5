# SPDX-License-Identifier: BSD-3-Clause
"""Classes and functions of a C++ source, found without a compiler.

read(text) returns a Reader with two lists:

    classes    every class, struct and union that is defined, also nested and local ones
    functions  every body of a function, from brace to brace, with the lambdas in it. A lambda that
               a namespace or a class names is one, too; so are methods of local classes, which the
               function around them counts as well, and macros of more than one line.

The reader knows declarations, but neither types nor macros: it does not see members that a macro
makes, nor that a name of a type stands for bool. It reads all branches of #if. It raises ValueError
where brackets do not close.

Guarded by tests/regression/test_limits.py.
"""

import re
from dataclasses import dataclass, field

TOKEN = re.compile(
    r"""
      (?P<directive>^[ \t]*\#(?://[^\n]*|/\*.*?\*/|\\\r?\n|[^\n])*)
    | (?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)
    | (?P<raw>(?:u8|[uUL])?R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)")
    | (?P<text>(?:u8|[uUL])?(?:"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'))
    | (?P<number>\.?\d(?:[eEpP][+-]|'?[\w.])*)
    | (?P<word>[A-Za-z_]\w*)
    | (?P<sign>::|->|<<|<=|>=|==|!=|&&|\|\||\.\.\.|[^\s\w])
    """,
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)
WORD = re.compile(r"[A-Za-z_]\w*$")
MACRO = re.compile(r"[A-Z][A-Z0-9_]{2,}$")
CLOSING = {"(": ")", "[": "]", "{": "}"}
CLASS_KEYS = {"class", "struct", "union"}
ACCESS = {"public", "protected", "private"}
# Words with parentheses that are neither a function nor its parameters.
BRACKETED = {"decltype", "alignas", "noexcept", "explicit", "__attribute__", "__declspec", "requires"}
SPECIFIERS = {"const", "mutable", "volatile", "static", "inline", "constexpr", "std", "::", "&"}
FLAGS = {"bool", "optional<bool>", "atomic<bool>", "atomic_bool", "atomic_flag"}
# A lambda can begin after these and their like; after a word or a bracket, [ is a subscript.
BEFORE_SUBSCRIPT = re.compile(r"[\w\])\"']$")


@dataclass
class Class:
    """A class: what it holds and what it offers. Static constants are no members."""

    name: str  # with namespaces but Harmos, without template arguments
    line: int
    members: list = field(default_factory=list)
    flags: list = field(default_factory=list)  # those of the members that are true or false
    # Names of public functions. Overloads are one; constructors, destructors, operators, friends
    # and what is deleted or defaulted are none.
    methods: set = field(default_factory=set)
    is_record: bool = True  # all is public, and no function of its own changes it

    @property
    def short_name(self):
        return self.name.rpartition("::")[2]


@dataclass
class Function:
    name: str
    first: int  # line of the opening brace
    last: int  # of the closing one

    @property
    def length(self):
        return self.last - self.first + 1


@dataclass
class Place:
    """Where declarations stand: the names around them, their class if any, and its access."""

    names: tuple = ()
    cls: Class = None
    access: str = "public"


def tokens_of(text):
    """(token, line) without comments; a literal is "", a number is 0, a directive is its text."""
    result, line, last = [], 1, 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", last, match.start())
        last = match.start()
        kind = match.lastgroup if match.lastgroup != "mark" else "raw"
        if kind in ("raw", "text"):
            result.append(('""', line))
        elif kind == "number":
            result.append(("0", line))
        elif kind in ("directive", "word", "sign"):
            result.append((match.group().lstrip(), line))
    return result


def macro(text, line):
    """A macro as a function; None for other directives."""
    found = re.match(r"#\s*define\s+(\w+)", text)
    return Function(found.group(1), line, line + text.count("\n")) if found else None


class Reader:
    """A walk over the tokens of a source; `at` is the next one."""

    def __init__(self, text):
        tokens = tokens_of(text)
        self.tokens = [(token, line) for token, line in tokens if token[0] != "#" or token == "#"]
        self.at = 0
        self.classes = []
        macros = [macro(token, line) for token, line in tokens if token[0] == "#"]
        self.functions = [found for found in macros if found and found.length > 1]
        self.scope(Place())
        if self.at < len(self.tokens):
            raise ValueError(f"line {self.line()}: a brace closes nothing")

    # ---- tokens

    def token(self, ahead=0):
        place = self.at + ahead
        return self.tokens[place][0] if 0 <= place < len(self.tokens) else ""

    def line(self, place=None):
        place = min(self.at if place is None else place, len(self.tokens) - 1)
        return self.tokens[place][1] if self.tokens else 1

    def after_bracket(self, place):
        """Behind the bracket that closes the one at `place`."""
        start, wanted = place, []
        while place < len(self.tokens):
            token = self.tokens[place][0]
            if token in CLOSING:
                wanted.append(CLOSING[token])
            elif token in CLOSING.values():
                if token != wanted.pop():
                    raise ValueError(f"line {self.line(place)}: {token} closes another bracket")
                if not wanted:
                    return place + 1
            place += 1
        raise ValueError(f"line {self.line(start)}: {self.tokens[start][0]} is not closed")

    def after_angles(self, place, are_parameters=False):
        """Behind the > that closes the < at `place`; None where < is a comparison.

        Parameters of a template, unlike arguments, have defaults."""
        depth = 0
        while place < len(self.tokens):
            token = self.tokens[place][0]
            if token in CLOSING:
                place = self.after_bracket(place)
                continue
            if token in (";", *CLOSING.values()) or (token == "=" and not are_parameters):
                return None
            depth += (token == "<") - (token == ">")
            place += 1
            if depth == 0:
                return place
        return None

    def skip_to(self, *ends):
        """Up to one of the tokens `ends` that stands outside of brackets."""
        while self.at < len(self.tokens) and self.token() not in (*ends, "}"):
            self.at = self.after_bracket(self.at) if self.token() in CLOSING else self.at + 1

    def skip_angles(self):
        self.at = (self.token() == "<" and self.after_angles(self.at)) or self.at + 1

    def skip_attributes(self):
        while self.token() == self.token(1) == "[" or self.token() in ("alignas", "__attribute__"):
            self.at = self.after_bracket(self.at + (self.token() != "["))

    # ---- scopes

    def scope(self, place):
        """Declarations up to the end of a namespace or a class."""
        while self.at < len(self.tokens) and self.token() != "}":
            token = self.token()
            if token == ";":
                self.at += 1
            elif place.cls and token in ACCESS and self.token(1) == ":":
                place.access = token
                self.at += 2
            elif token == "namespace" or (token == "inline" and self.token(1) == "namespace"):
                self.namespace(place)
            elif token == "extern" and self.token(1) == '""':
                self.at += 2
                if self.token() == "{":
                    self.block(place)
            elif token == "template":
                self.at += 1
                if self.token() == "<":
                    self.at = self.after_angles(self.at, are_parameters=True) or self.at + 1
                else:  # an explicit instantiation
                    self.skip_to(";")
            elif token in ("using", "typedef", "static_assert"):
                self.skip_to(";")
            elif MACRO.match(token) and self.is_statement(place):
                self.at = self.after_bracket(self.at + 1)
            else:
                Declaration(self, place).read()

    def is_statement(self, place):
        """Whether a macro with arguments stands alone, with a semicolon or without one."""
        if self.token(1) != "(" or (place.cls and self.token() == place.cls.short_name):
            return False
        behind = self.after_bracket(self.at + 1)
        next_token = self.tokens[behind][0] if behind < len(self.tokens) else ""
        if next_token in ("const", "noexcept"):
            return False
        return WORD.match(next_token) is not None or next_token == ";"

    def block(self, place):
        """The declarations in the braces that begin here."""
        start = self.at
        self.at += 1
        self.scope(place)
        if self.token() != "}":
            raise ValueError(f"line {self.line(start)}: a brace is not closed")
        self.at += 1

    def namespace(self, place):
        names = list(place.names)
        self.at += 2 if self.token() == "inline" else 1
        while self.token() not in ("{", ";", "=", ""):
            if WORD.match(self.token()) and self.token() not in ("Harmos", "inline"):
                names.append(self.token())
            self.at += 1
        if self.token() == "{":
            self.block(Place(tuple(names)))
        else:
            self.skip_to(";")

    # ---- classes

    def is_class(self):
        """Whether a class is defined here, rather than named."""
        if self.token() not in CLASS_KEYS:
            return False
        before, self.at = self.at, self.at + 1
        self.skip_attributes()
        while WORD.match(self.token()) or self.token() in ("::", "<"):
            if self.token() == "<" and self.after_angles(self.at) is None:
                break
            self.skip_angles()
            self.skip_attributes()
        result = self.token() in ("{", ":")
        self.at = before
        return result

    def class_(self, place):
        """The class that is defined here; without a name, its members are those of the class around."""
        line, name = self.line(), []
        access = "private" if self.token() == "class" else "public"
        self.at += 1
        self.skip_attributes()
        while self.token() not in ("{", ":"):
            token = self.token()
            if WORD.match(token) and token != "final":
                # A word that no :: follows is a macro.
                name = [*name, token] if name and self.token(-1) == "::" else [token]
            self.skip_angles()
            self.skip_attributes()
        while self.token() not in ("{", ""):  # bases
            self.skip_angles()
        if self.token() == "":
            raise ValueError(f"line {line}: a class without a body")
        behind = self.after_bracket(self.at)
        if not name and place.cls and self.tokens[behind : behind + 1] and self.tokens[behind][0] == ";":
            self.block(Place(place.names, place.cls, place.access))
            return
        names = (*place.names, "::".join(name) or "unnamed")
        cls = Class("::".join(names), line)
        self.classes.append(cls)
        self.block(Place(names, cls, access))

    # ---- bodies

    def body(self, name, place):
        """A function's body, which begins here, with the classes that are local to it."""
        end = self.after_bracket(self.at)
        self.functions.append(Function(name, self.line(), self.line(end - 1)))
        self.local_classes(end, place)

    def local_classes(self, end, place):
        while self.at < end:
            if self.token() in CLASS_KEYS and self.token(-1) != "enum" and self.is_class():
                self.class_(Place(place.names))
            else:
                self.at += 1

    def initialiser(self, name, place, ends=(",", ";")):
        """Up to its end. Functions in it are lambdas."""
        while self.at < len(self.tokens) and self.token() not in (*ends, "}"):
            if self.token() == "[" and not BEFORE_SUBSCRIPT.search(self.token(-1)):
                self.lambda_(name, place)
            elif self.token() in CLOSING:
                end = CLOSING[self.token()]
                self.at += 1
                self.initialiser(name, place, ends=(end,))
                self.at += 1
            elif self.token() == "<":
                self.skip_angles()
            else:
                self.at += 1

    def lambda_(self, name, place):
        self.at = self.after_bracket(self.at)
        if self.token() == "<":
            self.skip_angles()
        while self.token() not in ("{", ";", ",", ")", "}", ""):
            if self.token() == "(":
                self.at = self.after_bracket(self.at)
            else:
                self.skip_angles()
        if self.token() == "{":
            self.body(name, place)


class Declaration:
    """One declaration of a namespace or a class: a function, or data of one or more names."""

    def __init__(self, reader, place):
        self.reader = reader
        self.place = place
        self.words = []  # specifiers, type and name so far; template arguments are one word
        self.is_friend = False

    def read(self):
        reader = self.reader
        while reader.at < len(reader.tokens):
            token = reader.token()
            if token in ("[", "alignas", "__attribute__") and self.skips_attribute():
                continue
            if token in CLASS_KEYS and reader.is_class():
                self.words.append("class")
                reader.class_(self.place)
            elif token == "enum":
                self.enumeration()
            elif token == "operator":
                return self.operator()
            elif token == "<":
                self.angles()
            elif token == "(":
                if self.parenthesis():
                    return None
            elif token in ("=", "{", ":", "[", ",", ";"):
                return self.data()
            elif token == "}":
                return None
            else:
                self.is_friend |= token == "friend"
                if token not in CLASS_KEYS:
                    self.words.append(token)
                reader.at += 1

    def skips_attribute(self):
        before = self.reader.at
        self.reader.skip_attributes()
        return self.reader.at != before

    def enumeration(self):
        reader = self.reader
        reader.at += 1
        reader.skip_attributes()
        while reader.token() in ("class", "struct"):
            reader.at += 1
        name = []
        while WORD.match(reader.token()) or reader.token() == "::":
            name.append(reader.token())
            reader.at += 1
            if reader.token() in ("{", ":", ";"):
                break
            if WORD.match(reader.token()) and reader.token(-1) != "::":
                self.words += ["".join(name)]
                return  # the enumeration is only named: `enum Kind kind_;`
        if reader.token() == ":":
            reader.skip_to("{", ";")
        if reader.token() == "{":
            reader.at = reader.after_bracket(reader.at)
        self.words.append("enum")

    def angles(self):
        reader = self.reader
        before = reader.at
        reader.skip_angles()
        self.words.append("".join(token for token, _ in reader.tokens[before : reader.at]))

    # ---- functions

    def name(self):
        """The name at the end of the words, with its classes and without template arguments."""
        result = []
        for word in reversed(self.words):
            behind = result[0] if result else ""
            if word.startswith("<"):
                continue
            if WORD.match(word):
                fits = behind in ("", "::")
            else:
                fits = word in ("::", "~") and WORD.match(behind) or word == "::" and behind == "~"
            if not fits:
                break
            result.insert(0, word)
        return "".join(result)

    def pointer_name(self, begin, end):
        """The name in `(*name)` or `(C::*name)`, up to `end` at most; None where it is no pointer."""
        tokens = [token for token, _ in self.reader.tokens[begin + 1 : end - 1]]
        star = next((k for k, token in enumerate(tokens) if token in ("*", "&", "&&")), None)
        if star is None or (star and tokens[star - 1] != "::"):
            return None
        names = [k for k, token in enumerate(tokens) if WORD.match(token) and token != "const"]
        return next((tokens[k] for k in names if k > star), "")

    def parenthesis(self):
        """What begins with a parenthesis; whether the declaration ended with it."""
        reader = self.reader
        if self.words and self.words[-1] in BRACKETED:
            reader.at = reader.after_bracket(reader.at)
            return False
        end = reader.after_bracket(reader.at)
        name = self.pointer_name(reader.at, end)
        if name is None or reader.tokens[end : end + 1] == [] or reader.tokens[end][0] not in ("(", "["):
            self.function(self.name())
            return True
        inside = [token for token, _ in reader.tokens[reader.at + 1 : end - 1]]
        if "(" in inside:  # a function whose result is such a pointer
            self.function(name)
            return True
        self.words += ["*", name]
        reader.at = reader.after_bracket(end)
        while reader.token() in ("const", "noexcept"):
            reader.at += 1
        return False

    def operator(self):
        reader = self.reader
        reader.at += 1
        if reader.token() == reader.token(1) == "(" or reader.token(1) == ")":
            reader.at += 2
        while reader.token() not in ("(", ";", ""):
            reader.at += 1
        self.function("operator", is_operator=True)

    def function(self, name, is_operator=False):
        """From its parameters to the end of its body or its declaration."""
        reader, place = self.reader, self.place
        parameters = reader.at
        reader.at = reader.after_bracket(reader.at)
        is_const = is_dropped = False
        while reader.token() not in ("{", ";", "}", ":", ",", ""):
            token = reader.token()
            is_const |= token == "const"
            if token == "=":
                is_dropped = reader.token(1) in ("delete", "default")
            if token in CLOSING:
                reader.at = reader.after_bracket(reader.at)
            elif token == "->":
                self.trailing_type()
            else:
                reader.at += 1
        if reader.token() == ":":
            self.constructor_list(name)
        if not self.is_friend:
            self.method(name, is_operator, is_const, is_dropped)
        if reader.token() == "{":
            if MACRO.match(name):  # TEST(Suite, case)
                given = [token for token, _ in reader.tokens[parameters + 1 : parameters + 4]]
                name = ".".join(token for token in given if WORD.match(token)) or name
            reader.body("::".join((*self.class_names(), name)), place)
            while reader.token() == "catch":  # of a function that is one try block
                reader.skip_to("{")
                reader.body(name, place)
        elif reader.token() == ",":
            reader.skip_to(";")

    def class_names(self):
        """The classes around, without the namespaces."""
        names = self.place.cls.name.split("::") if self.place.cls else []
        return names[-1:]

    def trailing_type(self):
        reader = self.reader
        reader.at += 1
        while reader.token() not in ("{", ";", "=", ""):
            if reader.token() == "(":
                reader.at = reader.after_bracket(reader.at)
            else:
                reader.skip_angles()

    def constructor_list(self, name):
        """Up to the body, past initialisers in braces."""
        reader = self.reader
        while reader.token() in (":", ","):
            reader.at += 1
            while WORD.match(reader.token()) or reader.token() in ("::", "<"):
                reader.skip_angles()
            closing = CLOSING.get(reader.token(), "}")
            reader.at += 1
            reader.initialiser(name, self.place, ends=(closing,))
            reader.at += 1
            if reader.token() == "...":
                reader.at += 1

    def method(self, name, is_operator, is_const, is_dropped):
        cls = self.place.cls
        if cls is None:
            return
        is_special = is_operator or name.startswith("~") or name == cls.short_name
        if self.place.access != "public" or "virtual" in self.words:
            cls.is_record = False
        if is_special or is_dropped:
            return
        if not is_const and "static" not in self.words:
            cls.is_record = False
        if self.place.access == "public":
            cls.methods.add(name)

    # ---- data

    def data(self):
        """Names, with their initialisers, up to the semicolon."""
        reader = self.reader
        while True:
            name = self.words[-1] if self.words else ""
            self.member(name)
            while reader.token() not in (",", ";", "}", ""):
                if reader.token() == "[":
                    reader.at = reader.after_bracket(reader.at)
                    continue
                opening = reader.token()
                reader.at += 1
                closing = (CLOSING[opening],) if opening in CLOSING else (",", ";")
                reader.initialiser(name, self.place, ends=closing)
                reader.at += opening in CLOSING
            if reader.token() != ",":
                break
            reader.at += 1
            self.next_name()
        if reader.token() == ";":
            reader.at += 1

    def next_name(self):
        """The declarator behind a comma, in place of the name before it."""
        reader = self.reader
        self.words = [word for word in self.words[:-1] if word not in ("*", "&")]
        while reader.token() not in (",", ";", "=", "{", "[", ":", "}", ""):
            if reader.token() == "(":
                end = reader.after_bracket(reader.at)
                self.words += ["*", self.pointer_name(reader.at, end) or ""]
                reader.at = reader.after_bracket(end)
            else:
                self.words.append(reader.token())
                reader.at += 1

    def member(self, name):
        """A datum of the class; a class, an enumeration or a bit field without a name is none."""
        cls, words = self.place.cls, self.words
        is_named = len(words) > 1 and WORD.match(name) and name not in ("class", "enum")
        if cls is None or not is_named or self.is_friend:
            return
        if "static" in words and {"const", "constexpr"} & set(words):
            return
        cls.members.append(name)
        kind = "".join(word for word in words[:-1] if word not in SPECIFIERS)
        if kind in FLAGS:
            cls.flags.append(name)
        if self.place.access != "public":
            cls.is_record = False


def read(text):
    return Reader(text)
