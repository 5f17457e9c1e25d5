# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in motion: the step of time of a model, and the velocities that it begins with."""

from dataclasses import dataclass, field


@dataclass
class Motion:
    """Of a model with *DYNAMIC; without one it is not there()."""

    place: str = ""
    increment: float = 0.0
    alpha: float = -0.05  # of Hilber, Hughes and Taylor
    velocities: dict = field(default_factory=dict)  # (node, dof from 1) -> value

    def there(self):
        return bool(self.place)

    def take(self, keyword, step):
        """*DYNAMIC of a step."""
        if "EXPLICIT" in keyword.options:
            raise ValueError(f"{keyword.place}: *DYNAMIC, EXPLICIT is not supported")
        if not keyword.rows or len(keyword.rows[0].texts) < 2:
            raise ValueError(f"{keyword.place}: *DYNAMIC needs the length of increments and of the step")
        self.place, self.increment = keyword.place, keyword.rows[0].number(0)
        step.period = keyword.rows[0].number(1)
        self.alpha = float(keyword.option("ALPHA", "-0.05"))
        if not 0.0 < self.increment <= step.period or not -1.0 / 3.0 <= self.alpha <= 0.0:
            raise ValueError(f"{keyword.place}: *DYNAMIC needs 0 < increment <= step, and ALPHA from -1/3 to 0")

    def take_velocities(self, keyword, model):
        """*INITIAL CONDITIONS, TYPE=VELOCITY."""
        for row in keyword.rows:
            for node in model.node_list(row.text(0), row.place):
                self.velocities[node, row.integer(1)] = row.number(2)

    def faults(self, model):
        """What of a model does not go with it."""
        if self.there() and len(model.steps) > 1:
            return [f"{self.place}: *DYNAMIC beside other steps is not supported"]
        if self.velocities and not self.there():
            return ["*INITIAL CONDITIONS, TYPE=VELOCITY needs a step with *DYNAMIC"]
        return []

    def steps(self, period):
        """Of a deck. The spectral radius is that of Hilber, Hughes and Taylor's method."""
        number = max(1, round(period / self.increment))
        return {
            "Time integration": "Newmark", "Spectral radius": (1.0 + self.alpha) / (1.0 - self.alpha),
            "Number": number, "End time": period,
        }

    def of_body(self, name, nodes):
        """The velocity of all nodes of a body; None: it is at rest."""
        known = {tuple(self.velocities.get((node, dof), 0.0) for dof in (1, 2, 3)) for node in nodes}
        if len(known) > 1:
            raise ValueError(f"body {name}: initial velocities that vary within a body are not supported")
        velocity = list(known.pop())
        return velocity if any(velocity) else None
