# SPDX-License-Identifier: BSD-3-Clause
"""What the steps of a model prescribe and load, over time."""

from collections import defaultdict

import numpy as np


class History:
    """Values over time, and the histories that a deck needs for them."""

    def __init__(self, model):
        self.model = model
        self.names = {}  # ((time, factor), ...) -> name

    def step_ends(self):
        return np.cumsum([step.period for step in self.model.steps])

    def series(self, kind):
        """key -> [(time, value)] of one kind of entries (place, ..., value, amplitude).

        Loads that a step gives again add up, and take the place of those of the step before; what is prescribed is
        that of the last line.
        """
        result, current, ends = defaultdict(list), {}, self.step_ends()
        for step, end in zip(self.model.steps, ends):
            begin, fresh = end - step.period, self.fresh(step, kind)
            gone = set(current) - set(fresh) if kind in step.resets else set()
            if kind == "boundary" and gone:
                raise ValueError(f"{step.place}: supports that are released (OP=NEW) are not supported")
            for key in gone:
                fresh[key] = (0.0, "", step.place)
            for key, (_, amplitude) in current.items():
                if key not in fresh and amplitude and self.model.amplitudes[amplitude][2]:
                    fresh[key] = (*current[key][0], amplitude, step.place)  # total time goes on
            for key, (value, amplitude, place) in fresh.items():
                points = result[key]
                if not points and begin > 0.0 and kind == "boundary":
                    raise ValueError(f"{place}: a support that begins in a later step is not supported")
                before = points[-1][1] if points else self.at_rest(kind, key)
                if self.model.motion.there():
                    before = value  # at once
                points += self.follow(amplitude, value, begin, end) if amplitude else [(begin, before), (end, value)]
                current[key] = ((value,), amplitude)
        return result

    def at_rest(self, kind, key):
        return self.model.initial.get(key[0], 0.0) if kind == "temperature" else 0.0

    def fresh(self, step, kind):
        """key -> (value, amplitude, place) of a step."""
        fresh = {}
        for place, *key, value, amplitude in getattr(step, kind):
            key = self.key_of(key)
            if key in fresh and kind in ("cload", "dload"):
                if fresh[key][1] != amplitude:
                    raise ValueError(f"{place}: a load with two amplitudes in one step is not supported")
                value += fresh[key][0]
            fresh[key] = (value, amplitude, place)
        return fresh

    @staticmethod
    def key_of(key):
        return tuple(tuple(part) if isinstance(part, list) else part for part in key)

    def follow(self, amplitude, value, begin, end):
        times, values, is_total = self.model.amplitudes[amplitude]
        shift = 0.0 if is_total else begin
        inside = sorted({begin, end, *(t + shift for t in times if begin < t + shift < end)})
        return [(t, float(np.interp(t - shift, times, values)) * value) for t in inside]

    def is_one_state(self):
        rough = any(i.friction for i in self.model.interactions.values())
        is_rough = rough and self.model.amplitudes
        return len(self.model.steps) == 1 and not is_rough and not self.model.motion.there()

    def of_sum(self, items):
        """Like of(), of a sum of factor · (scalar over time)."""
        if not items:
            return 0.0, ""
        times = sorted({float(t) for _, points in items for t, _ in points})
        sums = np.zeros(len(times))
        for factor, points in items:
            sums += factor * np.interp(times, *np.transpose([(float(t), float(value)) for t, value in points]))
        return self.of(list(zip(times, sums.tolist())))

    def of(self, points):
        """Magnitude and name of the history of scalars over time; "" in one state: the last value counts."""
        values = [float(value) for _, value in points]
        if self.is_one_state():
            return values[-1], ""
        magnitude = max(values, key=abs)
        if magnitude == 0.0:
            return 0.0, ""
        shape = tuple((float(t), value / magnitude) for (t, _), value in zip(points, values))
        jump, unique = 1e-9 * float(self.step_ends()[-1]), []
        for time, factor in shape:
            if unique and time <= unique[-1][0]:
                if factor == unique[-1][1]:
                    continue
                time = unique[-1][0] + jump  # the step before ends with another value
            unique.append((time, factor))
        name = self.names.setdefault(tuple(unique), f"history_{len(self.names) + 1}")
        return magnitude, name
