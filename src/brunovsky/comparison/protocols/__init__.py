"""Four protocols of fairness: what is held equal when laws are compared, as functions over one evaluation.

`swept` holds the linear part, `equal_effort` the effort in a physical input, `pareto` the tuning budget, `monte_carlo`
the draws; `mapped` is a map, which holds nothing equal but the grid.
Each takes a function that runs a law with parameters in a case and returns its metrics, and gives a frozen
result with rows for CSV, plain data for JSON, a figure, and sentences that are never stronger than its numbers.
"""

from brunovsky.comparison.protocols.coupling import Coupling
from brunovsky.comparison.protocols.coupling_figure import coupling_figure
from brunovsky.comparison.protocols.draws import Distribution, draw_case, noise_seed
from brunovsky.comparison.protocols.equal_effort import EqualEffort, equal_effort
from brunovsky.comparison.protocols.evaluation import Evaluate, Failure, Trial, step_sensitive_metrics
from brunovsky.comparison.protocols.explanation import Explanation
from brunovsky.comparison.protocols.figures import (
    equal_effort_figure,
    monte_carlo_figure,
    pareto_figure,
    swept_figure,
)
from brunovsky.comparison.protocols.map_figure import map_figure
from brunovsky.comparison.protocols.mapped import Axis, Map, mapped
from brunovsky.comparison.protocols.margin_rows import MarginRow
from brunovsky.comparison.protocols.margins import MeasuredLoopMargins
from brunovsky.comparison.protocols.margins_figure import margins_figure
from brunovsky.comparison.protocols.monte_carlo import MonteCarlo, monte_carlo
from brunovsky.comparison.protocols.monte_carlo_findings import monte_carlo_headline
from brunovsky.comparison.protocols.pareto import Pareto, pareto
from brunovsky.comparison.protocols.swept import Swept, swept
from brunovsky.comparison.protocols.tuning import Knob, Tuning

__all__ = [
    "Axis",
    "Coupling",
    "Distribution",
    "EqualEffort",
    "Evaluate",
    "Explanation",
    "Failure",
    "Knob",
    "Map",
    "MarginRow",
    "MeasuredLoopMargins",
    "MonteCarlo",
    "Pareto",
    "Swept",
    "Trial",
    "Tuning",
    "coupling_figure",
    "draw_case",
    "equal_effort",
    "equal_effort_figure",
    "map_figure",
    "mapped",
    "margins_figure",
    "monte_carlo",
    "monte_carlo_figure",
    "monte_carlo_headline",
    "noise_seed",
    "pareto",
    "pareto_figure",
    "step_sensitive_metrics",
    "swept",
    "swept_figure",
]
