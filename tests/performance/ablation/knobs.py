# SPDX-License-Identifier: BSD-3-Clause
"""What an ablation of the QP layer changes: its constants, which are found, and its rescues, which are listed.

A constant is each number that a `constexpr double` or `constexpr int` of packages/qp names. It becomes a knob of the
name FILE.NAME and is tried at three times its value and at a third. A rescue is a place that gives up when a switch is
on. Texts that are not there exactly once are refused, so that the list cannot rot.
"""

import re
from dataclasses import dataclass
from pathlib import Path

PACKAGE = "packages/qp/src"
DECLARATION = re.compile(r"^(\s*)(static )?constexpr (double|int) ([^;]*);", re.M)
NUMBER = re.compile(r"^(\w+) = ([-+]?[0-9][0-9.e+-]*)$")

# A third of these is senseless.
VALUES = {"BalancedActiveSet.widening": [4.5, 1.17]}

# Numbers that are no choice of a method.
FIXED = {
    "BoundKernels.open": "stands for infinity",
    "FixedPointSolver_def.open": "stands for infinity",
    "FirstFace.beyond": "stands for infinity",
}


@dataclass(frozen=True)
class Place:
    """A piece of text and what takes its place, which names the knob."""

    knob: str
    file: str
    old: str
    new: str
    values: tuple
    meaning: str


def switch(knob, file, before, meaning):
    """A rescue that `return false` ends, right behind a piece of text."""
    new = f'{before}\n  if (HARMOS_TUNED("{knob}", 0.0) != 0.0)\n    return false;'
    return Place(knob, f"{PACKAGE}/{file}", before, new, (1.0,), meaning)


def number(knob, file, old, value, meaning, values=None):
    """A number within an expression: {} in the old text."""
    tuned = f'HARMOS_TUNED("{knob}", {value})'
    return Place(
        knob, f"{PACKAGE}/{file}", old.replace("{}", str(value)), old.replace("{}", tuned),
        values or (3 * value, value / 3), meaning,
    )


PDAS = "solvers/Harmos_PdasSolver_def.hpp"
AUTO = "solvers/Harmos_AutoSolver_def.hpp"
BALANCED = "newton/Harmos_BalancedFaces.hpp"
DESCENT = "newton/Harmos_FaceDescent.hpp"
FIRST = "newton/Harmos_FirstFace.hpp"
FIXED_POINT = "solvers/Harmos_FixedPointSolver_def.hpp"

RESCUES = (
    switch("off: balanced sets", BALANCED, "    if (!mayBalance() || stiffening_ >= stiffest)\n      return false;",
           "all sets balanced with springs, after a circle or no progress"),
    switch("off: interior path", "newton/Harmos_InteriorRestart.hpp",
           "paths_ >= mostPaths || !(q > 0.0) || most <= 0)\n      return false;",
           "restart from an interior point"),
    switch("off: follow faces", DESCENT,
           "    if (descent_.isOn() || s.options.innerReduction < carefulReduction)\n      return false;",
           "smaller inner residuals where sets bring no progress"),
    switch("off: descent of sets", DESCENT, "(!s.problem.kind().isSet && !sides_.areFrozen()))\n      return false;",
           "sets that descend from the best iterate"),
    switch("off: frozen sides", "newton/Harmos_FrozenSides.hpp",
           "    if (s.problem.kind().isSet || !s.problem.kind().isCost || areFrozen_)\n      return false;",
           "sides of soft bounds stay until the rest has converged"),
    switch("off: nearest set tried", FIRST,
           "    ActiveFace face = s_.face;\n    long long active = 0;\n    if (!nearest.find(face, active))\n      return false;",
           "the set of the nearest feasible point, where its residual is small"),
    Place("off: nearest set at bounds", f"{PACKAGE}/{FIRST}",
          "if (first == First::Nearest || isAtAllBounds(nearest.scale())) {",
          "if (first == First::Nearest ||\n"
          '          (HARMOS_TUNED("off: nearest set at bounds", 0.0) == 0.0 && isAtAllBounds(nearest.scale()))) {',
          (1.0,), "the same, where the start is at all bounds"),
    Place("off: start with active", f"{PACKAGE}/{FIRST}",
          "if (!hasPairs && s_.change.wrongSign2 <= mostWrong * atBounds2 && s_.solver.start(s_.face)) {",
          'if (!hasPairs && s_.change.wrongSign2 <= mostWrong * atBounds2 &&\n'
          '        HARMOS_TUNED("off: start with active", 0.0) == 0.0 && s_.solver.start(s_.face)) {',
          (1.0,), "the gradient at zero on the face where all bounds are active"),
    Place("off: kept directions", f"{PACKAGE}/{PDAS}",
          '  options.mostKept = list.get<int>("Kept directions");',
          '  options.mostKept =\n'
          '      HARMOS_TUNED("off: kept directions", 0.0) != 0.0 ? 0 : list.get<int>("Kept directions");',
          (1.0,), "directions of outlying eigenvalues kept for all faces"),
    Place("off: nearest set on faces", f"{PACKAGE}/{BALANCED}",
          "    const bool isFit = next_.isFit() && mayChange;",
          '    const bool isFit = next_.isFit() && mayChange && HARMOS_TUNED("off: nearest set on faces", 0.0) == 0.0;',
          (1.0,), "a balanced set where a face cannot hold bodies"),
    Place("off: overshoot of pairs", f"{PACKAGE}/{PDAS}",
          "return slipping.residual <= onFace_.target && slipping.overshoot <= mostOvershoot;",
          "return slipping.residual <= onFace_.target &&\n"
          '         (slipping.overshoot <= mostOvershoot || HARMOS_TUNED("off: overshoot of pairs", 0.0) != 0.0);',
          (1.0,), "faces are followed until pairs are near their rims"),
    Place("off: return to rows", f"{PACKAGE}/{PDAS}",
          "    if (solver.returnToRows(state_.now.equalityDistance))",
          '    if (HARMOS_TUNED("off: return to rows", 0.0) == 0.0 && solver.returnToRows(state_.now.equalityDistance))',
          (1.0,), "conjugate gradients begin again from the equalities"),
    Place("off: refinement", f"{PACKAGE}/{PDAS}",
          "  isMoved_ = solver.isRefinable(); // the same face, from where x is now",
          '  isMoved_ = HARMOS_TUNED("off: refinement", 0.0) == 0.0 && solver.isRefinable();',
          (1.0,), "the same face again, where springs have cost digits"),
    Place("off: other method", f"{PACKAGE}/{AUTO}",
          "    const std::string why = k + 1 < stages.size() ?",
          '    const std::string why = k + 1 < stages.size() && HARMOS_TUNED("off: other method", 0.0) == 0.0 ?',
          (1.0,), "MPRGP, SMALBE or fixed limits take over"),
    Place("off: relaxed limits", f"{PACKAGE}/{FIXED_POINT}",
          "  if (last > 0.0 && change2 > 0.0)",
          '  if (last > 0.0 && change2 > 0.0 && HARMOS_TUNED("off: relaxed limits", 0.0) == 0.0)',
          (1.0,), "Aitken's factor for limits that are updated"),
)

NUMBERS = (
    Place("PDAS.Inner reduction", f"{PACKAGE}/{PDAS}",
          '* list.get<double>("Inner reduction");',
          '* HARMOS_TUNED("PDAS.Inner reduction", 1.0) * list.get<double>("Inner reduction");',
          (1.8, 1.0 / 3.0), "of the residual on a face (0.5), as a factor"),
    Place("PDAS.Sets without progress", f"{PACKAGE}/{PDAS}",
          '  options.patience = list.get<int>("Active sets without progress");',
          '  options.patience = static_cast<int>(HARMOS_TUNED("PDAS.Sets without progress", 1.0) *\n'
          '                              list.get<int>("Active sets without progress"));',
          (3.0, 1.0 / 3.0), "before something else is tried (10), as a factor"),
    Place("PDAS.Share of iterations", f"{PACKAGE}/{PDAS}",
          'static_cast<int>(list.get<double>("Share of iterations") * left)',
          'static_cast<int>(HARMOS_TUNED("PDAS.Share of iterations", 1.0) *\n'
          '                                                 list.get<double>("Share of iterations") * left)',
          (1.9, 1.0 / 3.0), "before another method takes over (0.5), as a factor"),
    Place("PDAS.discs", f"{PACKAGE}/{PDAS}",
          "options.innerReduction = (turns ? 0.5 : 1.0)",
          'options.innerReduction = (turns ? HARMOS_TUNED("PDAS.discs", 0.5) : 1.0)',
          (1.0, 0.5 / 3.0), "factor of the inner reduction where pairs turn"),
    number("PDAS.half", "newton/Harmos_NewtonState.hpp", "    if (least_ < {} * mark_) {", 0.5, "what is called progress",
           (0.9, 0.17)),
    number("InteriorPath.step", "sets/Harmos_InteriorPath.hpp", "length < 1.0 ? {} * length : 1.0", 0.95,
           "of the way to the boundary", (0.99, 0.85)),
)


def stem(file):
    return Path(file).name.removeprefix("Harmos_").split(".")[0]


def constants(file, text):
    """The text with a knob for each constant; their values to be tried."""
    trials = {}

    def knob(name, kind, value):
        key = f"{stem(file)}.{name}"
        while key in trials:
            key += "'"
        if key in FIXED:
            return None
        number_ = float(value)
        low = number_ / 3 if kind == "double" else max(1, int(number_) // 3)
        trials[key] = VALUES.get(key, [v for v in (3 * number_, low) if v != number_])
        return key

    def replaced(match):
        indent, static, kind, rest = match.groups()
        found = [NUMBER.match(part) for part in rest.split(", ")]
        if not all(found):
            return match.group(0)
        is_member = bool(static and indent)
        plain, tuned = [], []
        for name, value in (item.groups() for item in found):
            key = knob(name, kind, value)
            literal = value if kind == "int" or "." in value or "e" in value else value + ".0"
            if key is None:
                plain.append(f"{name} = {literal}")
            else:
                tuned.append(f'{name}{{"{key}", {literal}}}' if is_member else f'{name} = HARMOS_TUNED("{key}", {literal})')
        lines = [f"{indent}{static or ''}constexpr {kind} {', '.join(plain)};"] if plain else []
        if tuned:
            what = f"static inline const ::Harmos::tuning::Constant<{kind}>" if is_member else f"const {kind}"
            lines.append(f"{indent}{what} {', '.join(tuned)};")
        return "\n".join(lines)

    return DECLARATION.sub(replaced, text), trials


def names_of(root):
    """Of all numbers that are named, FIXED ones too."""
    for path in (root / PACKAGE).rglob("*.[hc]pp"):
        for match in DECLARATION.finditer(path.read_text(encoding="utf-8")):
            for part in match[4].split(", "):
                if found := NUMBER.match(part):
                    yield f"{stem(path.name)}.{found[1]}"


def planted(root):
    """Puts all knobs into the sources below a folder. @return the values of each to be tried."""
    trials = {}
    for place in RESCUES + NUMBERS:
        path = root / place.file
        text = path.read_text(encoding="utf-8")
        if text.count(place.old) != 1:
            raise SystemExit(f"{place.knob}: {place.file} has {text.count(place.old)} times {place.old!r}")
        path.write_text(text.replace(place.old, place.new), encoding="utf-8")
        trials[place.knob] = list(place.values)
    missing = (set(FIXED) | set(VALUES)) - set(names_of(root))
    if missing:
        raise SystemExit(f"there are no constants {', '.join(sorted(missing))}")
    for path in sorted((root / PACKAGE).rglob("*.[hc]pp")):
        text, found = constants(path.name, path.read_text(encoding="utf-8"))
        trials |= found
        if "HARMOS_TUNED" in text or "tuning::Constant" in text:
            first = text.index("#include")
            text = text[:first] + '#include "Harmos_Tuning.hpp"\n' + text[first:]
            path.write_text(text, encoding="utf-8")
    return trials
