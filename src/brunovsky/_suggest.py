"""Near names for messages about unknown ones."""

from collections.abc import Iterable
from difflib import get_close_matches


def unknown_name(kind: str, name: str, known: Iterable[str]) -> str:
    """Sentence for a name that isn't there: the nearest one that is, or all of them."""
    names = list(known)
    near = get_close_matches(name, names, 1, 0.5) or [one for one in names if one.lower() == name.lower()]
    hint = f"did you mean '{near[0]}'?" if near else f"there is {', '.join(names) or 'none'}"
    return f"no {kind} '{name}'; {hint}"
