"""The outer loops of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import AfterValidator, Field, FiniteFloat, PlainSerializer, ValidationInfo, model_validator

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.study.keys import known_parameter, loop_keys, parameter_keys
from brunovsky.comparison.study.loops import FAMILY, IDEAL, Hardware, LawKind, Loop, loop_of
from brunovsky.comparison.study.table import StudyTable, by_name, in_range, known_key

SWITCHING = ("P", "phi")  # what a law of the paper's family sets, and nothing else does
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$")]


def _law_parameter(text: str, info: ValidationInfo) -> str:
    kind = info.data.get("kind")
    if kind is not None and kind not in FAMILY:
        return known_key(text, loop_keys(loop_of(kind)), f"parameter or unit of the kind '{kind}'")
    if known_parameter(text, FAMILY).variable.name not in SWITCHING:
        raise ValueError("is shared by all laws, which differ only in P and phi; move it to [parameters] or a scenario")
    return text


LawTable = Annotated[
    Mapping[Annotated[str, AfterValidator(_law_parameter)], FiniteFloat],
    AfterValidator(in_range),
    PlainSerializer(dict),
]


class Law(StudyTable):
    """One outer loop.

    The paper's family shares one linear part and differs in the switching term: ``linear`` is pole placement (P = 0),
    ``saturation`` the boundary layer (phi > 0), ``sign`` the relay (phi = 0). The other kinds are outer loops of the
    library, with all their parameters; what a study gives for all laws holds for them too where they have it.
    """

    name: Name
    kind: LawKind
    title: str = ""
    parameters: LawTable = Field(default_factory=lambda: FrozenMapping({}))

    @model_validator(mode="after")
    def _check_kind(self) -> Law:
        given = set(self.given)
        if self.kind == "linear" and given:
            raise ValueError("a linear law has no switching term: remove its parameters, or choose another kind")
        if self.kind == "sign" and "phi" in given:
            raise ValueError("kind 'sign' means phi = 0: remove phi, or choose kind 'saturation'")
        if self.kind == "saturation" and self.values["phi"] <= 0.0:
            raise ValueError("kind 'saturation' needs phi > 0; for phi = 0 choose kind 'sign'")
        return self

    @property
    def in_family(self) -> bool:
        """Whether it is the paper's law, with P or without."""
        return self.kind in FAMILY

    @property
    def given(self) -> dict[str, float]:
        """What the file gives for this law, by the names of the model."""
        return by_name(self.parameters, parameter_keys() if self.in_family else loop_keys(loop_of(self.kind)))

    @property
    def values(self) -> dict[str, float]:
        """Parameters that belong to this law, by their names in the model; P and phi for the paper's family."""
        if not self.in_family:
            return self.given
        forced = {"linear": {"P": 0.0}, "sign": {"phi": 0.0}}.get(self.kind, {})
        defaults = {one.name: one.value for one in self.loop().block.parameters if one.name in SWITCHING}
        return defaults | self.given | forced

    def loop(self, hardware: Hardware = IDEAL) -> Loop:
        """The closed loop under this law, with hardware around it."""
        return loop_of(self.kind, hardware)
