"""What each protocol of fairness holds equal, and what it cannot say, for the report."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

from brunovsky.comparison.facts import number


@dataclass(frozen=True)
class Explanation:
    """A protocol in words.

    Attributes
    ----------
    title : str
        Its heading.
    holds_equal : str
        What is the same for all laws.
    cannot_say : str
        What does not follow from its numbers.
    reading : str
        How its figure is read.
    """

    title: str
    holds_equal: str
    cannot_say: str
    reading: str = ""

    def as_dict(self) -> dict[str, str]:
        """The same by name, ready for JSON."""
        return asdict(self)


SWEPT = Explanation(
    "Same linear part, one parameter swept",
    "All laws share plant, start, reference, disturbances, noise, step and the linear part of the outer loop; only the "
    "swept parameter changes, from run to run, over the same values for every law. At zero of the switching gain the "
    "laws are one and the same linear law, so that each curve shows what the switching term adds. A metric that varies "
    "by at most five per cent of its largest value over all values is said to hardly depend on the parameter.",
    "Equal values of the parameter are not equal costs: a law may take more of the inputs for the same value. Each "
    "point is one run of one case, without spread, so that the curves say nothing about other starts or disturbances, "
    "nor which law is better when each is tuned for itself.",
    "Each marker is one run; the lines only join the runs of a law, and each panel is one metric over the swept "
    "parameter.",
)
EQUAL_EFFORT = Explanation(
    "Equal effort",
    "All laws spend the same of one physical input, the metric named as effort, within the stated tolerance. Each has "
    "one knob and the same range of evaluations to be tuned with; all else is the same case. A law whose effort cannot "
    "be brought to the target is reported with the reason, and not compared.",
    "Effort is equal in the one metric that was chosen; peaks, variation or the other input may still differ. The "
    "comparison holds at this target and for this case: at another target the order may be another. One knob for each "
    "law is not the best that the law can do.",
    "Above, the effort over the knob: small markers are the runs of the search, joined by lines, large ones the runs "
    "at the target. Below, one metric in each panel with a row for each law: its value at equal effort, and ≈ where "
    "it changes by more than 1 % at half the step; a row without a marker is a law that was not compared.",
)
PARETO = Explanation(
    "Pareto fronts with an equal tuning budget",
    "Each law is tried at the same number of designs, spread over the logarithms of its knobs by the same kind of "
    "scrambled Sobol sequence, on the same case. A design is on the front if no other of that law is at least as good "
    "in both objectives and better in one.",
    "A front is that of the designs that were tried: another seed, more designs or wider ranges may move it, and a law "
    "with more knobs has its designs spread more thinly. A law whose knobs have the wider ranges is searched more "
    "coarsely. Fronts hold for one case; what lies off the two objectives is not weighed. The hypervolume depends on "
    "its reference point and ranks nothing by itself.",
    "Small markers are designs, each one run; the stepped line with large markers is a law’s front, towards the lower "
    "left.",
)
MONTE_CARLO = Explanation(
    "Paired Monte-Carlo with common random numbers",
    "In each case all laws meet the same drawn parameters and the same noise, so that their difference is that of the "
    "laws and not of the luck of the draw; adding a law changes no draw. Means have bias-corrected and accelerated "
    "bootstrap intervals, medians the interval between order statistics, rates Wilson's interval. Two laws are told "
    "apart only where the intervals of the mean and of the median of the paired differences both exclude zero, on the "
    "same side, and the sign test with failed runs counted as the worse agrees.",
    "The intervals speak of the distributions that were drawn from, and of nothing outside them. Pairs of which one "
    "run failed have no difference: where failures are many, the differences are those of the easier cases. With many "
    "metrics some intervals exclude zero by chance. That an interval contains zero does not show that the laws are "
    "equal. The laws are not tuned for the distributions.",
)
MAP = Explanation(
    "Map",
    "Each law is run from every point of the same grid, all else equal; one scale of lightness holds for all laws, "
    "with lines of equal value. Where any of the mapped metrics of a run changes by more than one per cent at half "
    "the step, the run is in no sentence and no extreme. A map is no protocol of fairness: it shows how a law depends "
    "on what is swept, and where.",
    "Each point is one run, without spread. Between the points nothing was run: narrow valleys and ridges, such as the "
    "starts that pass near the singularity, are drawn only as finely as the grid is, and extremes are those of the "
    "grid. Laws are not tuned, and no point is more likely than another.",
    "The swept parameters replace those of the scenario; each cell is one run. White cells have no number: × failed, "
    "△ failed at this step and not at half of it, ○ ended without the metric being defined. A dot is a run of which a "
    "mapped metric changes by more than 1 % at half the step. Colours and lines, with their levels marked on the "
    "scale, are the same for all laws and span the other runs; a dotted cell beyond them has the colour of the end.",
)
MARGINS = Explanation(
    "Measured margins",
    "Each law does the same scenario with another gain, delay, lag or sampling period of its actuators; bisection "
    "narrows down the first place where it no longer does; "
    "all these runs are native, whatever the engine of the study. "
    "A run counts as stable if its position error stays within "
    "the stated bound over the last quarter without growing, which its root mean square does where it rises over each "
    "of the last four eighths of the run, by five per cent in all, to above 1 nm. Under a law whose sliding variable "
    "leaves its boundary layer then, an error below the stated size may grow, as chatter is not the same in each part. "
    "Beside it stands what the linear part (P = 0), and the linear loop within the boundary layer, are predicted to "
    "stand along the scenario’s motion. Sixty values between none and the place found are tried for an earlier loss: "
    "where there is one, it is told, and there is no margin. Both ends of the last "
    "bracket are run again at half of the step: where stability is lost more than five per cent away from what was "
    "found, that is a limit of the integration, told as a bound and not as a margin of the law.",
    "A nonlinear loop has no margin as such: these belong to the scenario’s start and duration. A loop may lose "
    "stability and regain it between two of the values that are tried, and a finite run cannot tell slow decay "
    "from slow growth. A law that chatters within the bound counts as stable, and what grows slowly beneath its "
    "chatter is not seen. A prediction is of small deviations; a start far from the reference is none.",
)
COUPLING = Explanation(
    "Coupling at communication points",
    "The same scenario with reference, law and robot as FMUs of their own, which exchange values at communication "
    "points alone, all at once or in sequence, held or continued by derivatives; against the same loop as one system, "
    "solved by Dormand-Prince with a tolerance of 1e-11. The error is the largest distance of the positions over all "
    "communication points. The limits are the steps at which one chain and its linear outer loop, coupled so, lose "
    "stability: without the switching term (P = 0), which is also the loop far outside a boundary layer, and with "
    "Q + P/φ in place of Q, the loop within it. In the figure a tick at the bottom is the former, a dashed one at the "
    "top the latter. “(|S| > φ)” marks a run that ends beyond the layer where the loop as one system is within it.",
    "The error is that of the coupling and of the internal steps of the components together. A limit of stability is "
    "that of a linear loop; it says nothing about accuracy. Other masters exchange in "
    "other orders.",
)


def margins_explained(bound: float, still: float) -> Explanation:
    """Measured margins in words, with the error that may remain and the chatter that may grow (m)."""
    return replace(
        MARGINS,
        holds_equal=MARGINS.holds_equal.replace("the stated bound", f"{number(1e3 * bound)} mm").replace(
            "the stated size", f"{number(1e3 * still)} mm"
        ),
    )
