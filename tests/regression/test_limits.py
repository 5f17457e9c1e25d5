# SPDX-License-Identifier: BSD-3-Clause
"""Limits on concepts: how much a class holds and offers, and how long a function is.

    members    a class has at most 15 data members, a record 25. A record is a class with public
               members only, no virtual function, and no function that changes it. Members of bases
               and static constants do not count; nested classes count on their own.
    flags      a class or a record has at most 3 members of type bool, std::optional<bool> or
               std::atomic<bool>.
    methods    a class or a record has at most 25 public methods. Overloads count once.
               Constructors, destructors, operators, friends, and deleted or defaulted functions do
               not count.
    lines      a function has at most 60 lines, in C++ from its opening to its closing brace, in
               Python from `def` to its end. Lambdas and local functions are part of it. A macro
               is a function.

size_limits.txt lists the exceptions, each with the topic that ends it. A recorded number is a limit
as well; an exception that is no longer needed is a fault. A file may have any length.

What each class guards against:

    Sizes      a class or a function beyond its limit
    Planted    a check that finds nothing: one fault each of a small tree must be found
    Counter    a wrong count: snippets of C++ with known members, flags, methods and bodies
"""

import ast
import functools
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_cpp as cpp  # noqa: E402
import harmos_runs as runs  # noqa: E402
import test_layout as layout  # noqa: E402

CLASS = {"members": 15, "flags": 3, "methods": 25}
RECORD = {"members": 25, "flags": 3, "methods": 25}
FUNCTION = {"lines": 60}

EXCEPTIONS = "tests/regression/size_limits.txt"
TOPICS = {"a semismooth core", "whole-run time", "models of others", "none yet"}

CPP = {".hpp", ".cpp", ".inc", ".h", ".c"}
COMMAND = re.compile(r"apps/tools/harmos-[a-z-]+")  # Python without a suffix


class Size:
    """What was counted of a class or a function, with its limits."""

    def __init__(self, file, line, name, counts, limits):
        self.place = f"{file}:{line}"
        self.key = (Path(file).name, name)
        self.counts = counts
        self.limits = limits


def cpp_sizes(file, text):
    result = []
    found = cpp.read(text)
    for cls in found.classes:
        counts = {"members": len(cls.members), "flags": len(cls.flags), "methods": len(cls.methods)}
        result.append(Size(file, cls.line, cls.name, counts, RECORD if cls.is_record else CLASS))
    for function in found.functions:
        result.append(Size(file, function.first, function.name, {"lines": function.length}, FUNCTION))
    return result


def python_sizes(file, text):
    result = []

    def visit(node, names):
        for child in ast.iter_child_nodes(node):
            inner = names
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                inner = (*names, child.name)
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)):
                lines = child.end_lineno - child.lineno + 1
                result.append(Size(file, child.lineno, ".".join(inner), {"lines": lines}, FUNCTION))
            visit(child, inner)

    visit(ast.parse(text), ())
    return result


def sizes(source):
    result = []
    for file in source.files:
        if Path(file).suffix in CPP:
            result += cpp_sizes(file, source.text(file))
        elif Path(file).suffix == ".py" or COMMAND.fullmatch(file):
            result += python_sizes(file, source.text(file))
    return result


def exceptions(text):
    """The numbers of a file of exceptions by (file, name), and its faults."""
    recorded, faults = {}, []
    for number, line in enumerate(text.splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        fields = [field.strip() for field in line.split("|")]
        pairs = re.findall(r"(members|flags|methods|lines) (\d+)", fields[2]) if len(fields) == 4 else []
        if not pairs or ", ".join(f"{kind} {count}" for kind, count in pairs) != fields[2]:
            faults.append(f"{EXCEPTIONS}:{number}: not `file | name | members n, flags n | topic`")
        elif fields[3] not in TOPICS:
            faults.append(f"{EXCEPTIONS}:{number}: {fields[3]} is none of {', '.join(sorted(TOPICS))}")
        elif (fields[0], fields[1]) in recorded:
            faults.append(f"{EXCEPTIONS}:{number}: {fields[1]} is listed twice")
        else:
            recorded[fields[0], fields[1]] = {kind: int(count) for kind, count in pairs}
    return recorded, faults


def excess_faults(found, recorded):
    """Classes and functions beyond their limits, and beyond what is recorded of them."""
    faults = []
    for size in found:
        mine = recorded.get(size.key, {})
        for kind, count in size.counts.items():
            limit = max(size.limits[kind], mine.get(kind, 0))
            if count > limit:
                faults.append(f"{size.place}: {size.key[1]}: {count} {kind}, more than {limit}")
    return faults


def exception_faults(found, recorded):
    """Exceptions that nothing needs."""
    needed = {
        (*size.key, kind)
        for size in found
        for kind, count in size.counts.items()
        if count > size.limits[kind]
    }
    return [
        f"{EXCEPTIONS}: {file}: {name} needs no exception for {kind}; remove it"
        for (file, name), counts in recorded.items()
        for kind in counts
        if (file, name, kind) not in needed
    ]


@functools.cache
def sizes_of_this_source():
    return sizes(layout.this_source())


class Sizes(layout.Checks):
    def setUp(self):
        super().setUp()
        self.sizes = sizes_of_this_source()
        self.recorded, self.faults = exceptions(self.source.text(EXCEPTIONS))

    def test_classes_and_functions(self):
        self.assert_none(excess_faults(self.sizes, self.recorded))

    def test_exceptions_are_needed(self):
        self.assert_none(exception_faults(self.sizes, self.recorded))

    def test_list_of_exceptions(self):
        self.assert_none(self.faults)

    def test_tree_is_read(self):
        """Each class head that a line begins with is among the classes."""
        head = re.compile(
            r"^ *(?:class|struct) (?:\w+::)*(\w+)(?:<[\w, ]*>)?(?: final)?(?: : [^;{]*)? \{", re.MULTILINE
        )
        found = {(size.place.split(":")[0], size.key[1].rpartition("::")[2]) for size in self.sizes}
        for file in self.source.files:
            if Path(file).suffix in CPP:
                code = layout.COMMENT.sub("", self.source.text(file))
                heads = {(file, name) for name in head.findall(code)}
                self.assertFalse(heads - found)


def lines(form, count):
    """`count` lines with their number in each."""
    return "".join("  " + form.format(k) + "\n" for k in range(count))


class Planted(unittest.TestCase):
    def faults(self, file, text, listed=""):
        top = runs.scratch("tree")
        (top / file).parent.mkdir(parents=True)
        (top / file).write_text(text, encoding="utf-8")
        found = sizes(layout.Source(top, [file]))
        recorded, faults = exceptions(listed)
        return [*faults, *excess_faults(found, recorded), *exception_faults(found, recorded)]

    def assert_limit(self, count, kind, text, name, line=1, file="packages/qp/src/Harmos_Planted.hpp"):
        """`text`, a function of a number, is right with `count`, and not with one more."""
        self.assertEqual(self.faults(file, text(count)), [])
        fault = f"{file}:{line}: {name}: {count + 1} {kind}, more than {count}"
        self.assertEqual(self.faults(file, text(count + 1)), [fault])
        listed = f"{Path(file).name} | {name} | {kind} {count + 1} | none yet\n"
        self.assertEqual(self.faults(file, text(count + 1), listed), [])
        fault = f"{file}:{line}: {name}: {count + 2} {kind}, more than {count + 1}"
        self.assertEqual(self.faults(file, text(count + 2), listed), [fault])
        fault = f"{EXCEPTIONS}: {Path(file).name}: {name} needs no exception for {kind}; remove it"
        self.assertEqual(self.faults(file, text(count), listed), [fault])

    def test_members(self):
        self.assert_limit(15, "members", lambda n: f"class C {{\n{lines('int a{}_ = 0;', n)}}};", "C")

    def test_members_of_a_record(self):
        self.assert_limit(25, "members", lambda n: f"struct C {{\n{lines('int a{};', n)}}};", "C")

    def test_flags(self):
        for key in ("class", "struct"):
            with self.subTest(key=key):
                self.assert_limit(3, "flags", lambda n: f"{key} C {{\n{lines('bool is{}_;', n)}}};", "C")

    def test_methods(self):
        self.assert_limit(25, "methods", lambda n: f"class C {{\n public:\n{lines('int f{}();', n)}}};", "C")

    def test_functions(self):
        for head, name, last in (
            ("int f(int a) {", "f", "}"),
            ("template<class T>\nT C<T>::f() const noexcept {", "C::f", "}"),
            ("class C {\n void f() {", "C::f", "}\n};"),
            ("C::C(int a)\n    : a_(1), b_{a} {", "C::C", "}"),
            ('int f(const char* a = "(", std::vector<int> b = {}) {', "f", "}"),
            ("static const T x = [] {", "x", "}();"),
            ("template<class T>\nclass C : public B<T> {\n void f() {", "C::f", "}\n};"),
            ("TEST(Suite, case_of_it) {", "Suite.case_of_it", "}"),
            ("auto f() -> decltype(g()) {", "f", "}"),
            ("void f()\ntry {", "f", "} catch (...) {\n}"),
        ):
            with self.subTest(head=head):
                text = lambda n: f"{head}\n" + (n - 2) * "  g({1}, [] { return 1; }); // }\n" + last  # noqa: E731
                self.assert_limit(60, "lines", text, name, 1 + head.count("\n"))

    def test_macros(self):
        text = lambda n: "#define M(x) \\\n" + (n - 2) * "  f(x); \\\n" + "  g(x)\n"  # noqa: E731
        self.assert_limit(60, "lines", text, "M")

    def test_python_functions(self):
        for file in ("tests/planted.py", "apps/tools/harmos-planted"):
            self.assert_limit(60, "lines", lambda n: "def f():\n" + (n - 1) * "    g()\n", "f", file=file)
        text = lambda n: "class C:\n    def f(self):\n" + (n - 1) * "        g()\n"  # noqa: E731
        self.assert_limit(60, "lines", text, "C.f", 2, file="docs/planted.py")

    def test_exception_of_nothing(self):
        listed = "a.hpp | C | members 20, flags 4 | a semismooth core\n"
        faults = self.faults("packages/qp/a.hpp", "class C {};", listed)
        wanted = [f"{EXCEPTIONS}: a.hpp: C needs no exception for {kind}; remove it" for kind in ("members", "flags")]
        self.assertEqual(faults, wanted)

    def test_list_that_cannot_be_read(self):
        form = f"{EXCEPTIONS}:1: not `file | name | members n, flags n | topic`"
        for given in ("members 20", "members 20 flags 4 | none yet", "lines | none yet", "lines 70 | x | none yet"):
            self.assertEqual(exceptions(f"a.hpp | C | {given}")[1], [form], given)
        self.assertEqual(len(exceptions("a.hpp | C | members 20 | some day")[1]), 1)
        line = "a.hpp | C | members 20 | none yet\n"
        self.assertEqual(exceptions(line + line)[1], [f"{EXCEPTIONS}:2: C is listed twice"])


class Counter(unittest.TestCase):
    def assert_class(self, text, members, flags="", methods="", is_record=None, name="C"):
        found = {cls.name: cls for cls in cpp.read(text).classes}
        self.assertIn(name, found)
        cls = found[name]
        self.assertEqual(cls.members, members.split())
        self.assertEqual(cls.flags, flags.split())
        self.assertEqual(cls.methods, set(methods.split()))
        if is_record is not None:
            self.assertEqual(cls.is_record, is_record)

    def assert_bodies(self, text, bodies):
        self.assertEqual([(f.name, f.first, f.last) for f in cpp.read(text).functions], bodies)

    def test_several_names(self):
        self.assert_class("class C { double a_ = 0, b_ = 0; };", "a_ b_")
        self.assert_class("class C { double a_ = 0, *b_ = nullptr, c_[3] = {0, 1}, d_{1}; };", "a_ b_ c_ d_")
        self.assert_class("class C { bool a_ = false, *b_, c_; };", "a_ b_ c_", "a_ c_")
        self.assert_class("class C { struct A a_[2], *b_; bool c_[3]; };", "a_ b_ c_", "c_")
        self.assert_class("class C { unsigned a_ : 3, b_ : 2; bool c_ : 1; unsigned : 2; };", "a_ b_ c_", "c_")

    def test_initialisers(self):
        self.assert_class("class C { int a_{1}; std::vector<int> b_{{1, 2}, {3}}; T c_ = {}; };", "a_ b_ c_")
        self.assert_class("class C { bool a_ = 1 < 2, b_ = x > 3; };", "a_ b_", "a_ b_")
        self.assert_class("class C { std::pair<int, int> a_ = std::pair<int, int>(1, 2); int b_; };", "a_ b_")
        self.assert_class("class C { F a_ = [](int b) { int c = b; return c; }; };", "a_")
        self.assert_class("class C { T a_{x, [this] { ++b_; }}; int b_ = 0; };", "a_ b_")

    def test_kinds_of_flags(self):
        self.assert_class(
            "class C { const bool a_; mutable bool b_; std::optional<bool> c_; std::atomic<bool> d_{false};"
            "std::atomic_bool e_; bool& f_; bool* g_; std::vector<bool> h_; std::array<bool, 2> i_; };",
            "a_ b_ c_ d_ e_ f_ g_ h_ i_",
            "a_ b_ c_ d_ e_ f_",
        )

    def test_static_constants(self):
        self.assert_class(
            "class C { static constexpr int a = 1; static const bool b; inline static int c;"
            "constexpr static T d{}; };",
            "c",
        )

    def test_types_of_members(self):
        self.assert_class(
            "class C { std::function<void(int, bool)> a_; void (*b_)(int); int (C::*c_)(bool) const = nullptr;"
            "std::map<int, std::vector<int>> d_; typename T::template X<int> e_; decltype(f()) g_; struct S* h_;"
            "enum Kind i_; enum { One, Two } j_; struct { int k; } l_; ::std::string m_; alignas(64) int n_;"
            "[[maybe_unused]] int o_; const int (&p_)[3]; };",
            "a_ b_ c_ d_ e_ g_ h_ i_ j_ l_ m_ n_ o_ p_",
        )

    def test_what_is_no_member(self):
        self.assert_class(
            "class C : public B<int>, private D { using A = int; using B::B; using B::f; typedef int E;"
            "enum F { G }; enum class H : int; friend class I; friend void g(C) {} struct J;"
            "friend bool operator==(C, C); static_assert(sizeof(int) == 4, \"x\");"
            "template<class T> struct K; template<class T> using L = T; };",
            "",
        )

    def test_nested_classes(self):
        text = (
            "class C { struct D { int a; class E { int b; int c; }; int d; } e_, f_; class G { int h; };"
            "int i_; };"
        )
        self.assert_class(text, "e_ f_ i_")
        self.assert_class(text, "a d", name="C::D")
        self.assert_class(text, "b c", name="C::D::E")
        self.assert_class(text, "h", name="C::G")

    def test_members_without_a_class_of_their_own(self):
        self.assert_class("class C { union { int a; bool b; }; struct { int c; }; };", "a b c", "b")

    def test_names(self):
        self.assert_class("namespace Harmos::qp { namespace { class C {}; } }", "", name="qp::C")
        self.assert_class("template<class T, class = X<T>> class A<T>::C final : B { int a; };", "a", name="A::C")
        self.assert_class("struct [[nodiscard]] C : B<decltype(f({}))>::D { int a; };", "a")
        self.assert_class("class EXPORT C { int a; };", "a")
        self.assert_class("struct alignas(64) C { int a; };", "a")
        self.assert_class("void f() { if (a) { struct C { int b; }; } }", "b")
        self.assert_class("auto f = [] { class C : B { int b; }; };", "b")

    def test_methods(self):
        self.assert_class(
            "class C { void p(); public: C(); explicit C(int a) : b_{a}, c_(1) {} ~C(); C(C&&) = default;"
            "C& operator=(const C&) = delete; bool operator()(int) const; operator bool() const { return true; }"
            "void f(); void f(int) const; static int g(); template<class T> T h(T a = {}, int b = 1) { return a; }"
            "virtual void i() = 0; auto j() const -> std::vector<int> { return {}; } void k() = delete;"
            "[[nodiscard]] const std::vector<int>& l() const noexcept(true) override; int (*m(int))(bool);"
            "friend void n(); protected: void o(); private: int b_, c_; };",
            "b_ c_",
            "",
            "f g h i j l m",
        )

    def test_records(self):
        for text, is_record in (
            ("struct C { int a; C(int b) : a(b) {} int f() const; static C g(); };", True),
            ("struct C { int a; bool operator==(const C&) const; C& operator+=(int); };", True),
            ("struct C { void f(); };", False),
            ("struct C { virtual int f() const; };", False),
            ("class C { int a; };", False),
            ("class C { public: int a; };", True),
            ("struct C { int a; private: int f() const; };", False),
            ("struct C { class D { int b; }; int a; };", True),
        ):
            self.assertEqual(cpp.read(text).classes[0].is_record, is_record, text)

    def test_text_that_is_no_code(self):
        self.assert_class(
            "class C { // int a; }\n/* bool b; */ const char* c_ = \"};\"; char d_ = '}';\n"
            'std::string e_ = R"x(\n#define {\n)" }; )x"; int f_ = 1\'000; // \\\n int g_;\n int h_; };',
            "c_ d_ e_ f_ h_",
        )

    def test_macros(self):
        self.assert_class("class C { HARMOS_MACRO(int, f)\n int a_;\n HARMOS_OTHER(x); int b_; };", "a_ b_")
        self.assert_class("#define X { \\\n {\nclass C {\n#if A\n int a_;\n#else\n int b_;\n#endif\n};", "a_ b_")
        self.assert_class("class CG { public: CG(int a) : b_(a) {} void f(); int b_; };", "b_", "", "f", name="CG")

    def test_bodies(self):
        self.assert_bodies("int f() {\n return 1;\n}\nint g();\nint C::h() {}", [("f", 1, 3), ("C::h", 5, 5)])
        self.assert_bodies("C::C() : a_{1}, b_([] {\n return 1; }()) {\n}\n", [("C::C", 1, 2), ("C::C", 2, 3)])
        self.assert_bodies("const X x[] = {{1, 'a'},\n {2, 'b'}};\nvoid f() {}", [("f", 3, 3)])
        self.assert_bodies("C::~C() {}\nbool C::operator<(C) const {}", [("C::~C", 1, 1), ("operator", 2, 2)])
        self.assert_bodies("#define M(a) \\\n f(a)\n#define N 1\n", [("M", 1, 2)])

    def test_brackets_that_do_not_close(self):
        for text in ("class C {", "int f() { (}", "}", "namespace a { int f() {}", "void f() { g(; }", "class C : B"):
            with self.assertRaises(ValueError, msg=text):
                cpp.read(text)


if __name__ == "__main__":
    runs.main()
