"""JSON schema of study files, for editors that complete and check them while they are written."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from brunovsky.comparison.study import Study
from brunovsky.comparison.study.keys import Key, all_parameter_keys, bounds, input_keys
from brunovsky.comparison.study.law import SWITCHING


def study_schema() -> dict[str, Any]:
    """JSON schema of a study file (draft 2020-12), with the keys of the model, their units and their ranges.

    What a schema does not say (which parameters a kind of law has, that laws a scenario names exist, that a boundary
    layer is not too thin for the step) is checked by :func:`load_study` alone.
    """
    schema = Study.model_json_schema()
    known = all_parameter_keys()
    shared = {text: key for text, key in known.items() if key.variable.name not in SWITCHING}
    definitions = schema["$defs"]
    _name_keys(schema, "parameters", shared)
    _name_keys(definitions["Scenario"], "parameters", shared)
    _name_keys(definitions["Scenario"], "disturbances", input_keys())
    _name_keys(definitions["Signal"], "amplitude", input_keys())
    _name_keys(definitions["Law"], "parameters", known)
    hardware = definitions["HardwareTable"]["properties"]
    for name in ("lag_s", "delay_s"):
        hardware[name] = _or_number(hardware[name])
    chatter = definitions["ChatterTable"]["properties"]
    chatter["delay_s"] = _or_number(chatter["delay_s"])
    chatter["parameters"]["additionalProperties"] = _or_number(chatter["parameters"]["additionalProperties"])
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def schema_text() -> str:
    """The schema as it is shipped, ``comparisons/study.schema.json``."""
    return json.dumps(study_schema(), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def _name_keys(table: dict[str, Any], name: str, keys: Mapping[str, Key]) -> None:
    """Replace a table of any keys by one of these."""
    properties = {text: _number(key) for text, key in keys.items()}
    table["properties"][name] = {
        "type": "object",
        "title": name,
        "properties": properties,
        "additionalProperties": False,
    }


def _number(key: Key) -> dict[str, Any]:
    low, high = bounds(key)
    unit = f" ({key.variable.unit})" if key.variable.unit != "1" else ""
    found: dict[str, Any] = {"type": "number", "description": f"{key.variable.description}{unit}"}
    if math.isfinite(low):
        found["minimum"] = low
    if math.isfinite(high):
        found["maximum"] = high
    return found


def _or_number(array: dict[str, Any]) -> dict[str, Any]:
    """A list of numbers, for which one number may stand."""
    about: dict[str, Any] = {name: array.pop(name) for name in ("default", "title") if name in array}
    if "minLength" in array:
        array["minItems"] = array.pop("minLength")
    return {**about, "anyOf": [{"type": "number"}, array]}
