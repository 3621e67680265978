"""The methods and formulations of the program, from its registries."""

import functools
from typing import NamedTuple

from spintop_figures.tables.listed import listed

OTHER = "other programs"
"""The family of what the registry does not have."""


class Method(NamedTuple):
    """A method: its family, its order if it has one, and its steps."""

    name: str
    family: str
    order: int | None
    kind: str
    """`fixed`, `adaptive`, `both` or `exact`."""

    @property
    def group(self) -> str:
        """The family and how the steps are chosen, in words."""
        return self.family + (", adaptive" if self.kind in ("adaptive", "both") else "")

    @property
    def height(self) -> int:
        """The order, by which the members of a family are sorted.

        An order that the tolerance chooses is above all, one that a table decides below all.
        """
        return self.order or (1000 if self.kind == "adaptive" else 0)


@functools.cache
def known_methods() -> dict[str, Method]:
    """The methods by name, in the order of the registry; Butcher tables are as their method."""
    methods: dict[str, Method] = {}
    for entry in read_registry():
        method = Method(entry["name"], entry["family"], entry["order"], entry["kind"])
        methods[method.name] = method
        for table in entry["tables"] or ():
            methods[table] = method
    return methods


def read_registry() -> list[dict]:
    """The registry of methods."""
    return listed("methods")["methods"]


def family_of(method: str) -> str:
    """The family of a method."""
    known = known_methods().get(method)
    return known.family if known else OTHER


def order_of(method: str) -> int | None:
    """The order of a method, if it has one."""
    known = known_methods().get(method)
    return known.order if known else None


def families() -> list[str]:
    """The families in the order of the registry, and that of other programs."""
    return [*dict.fromkeys(method.family for method in known_methods().values()), OTHER]


def members_of(family: str) -> list[str]:
    """The methods of a family: the highest order first, else as the registry has them."""
    methods = [method for method in known_methods().values() if method.family == family]
    methods.sort(key=lambda method: -method.height)
    return list(dict.fromkeys(method.name for method in methods))


def rank_of(method: str) -> tuple[int, int, str]:
    """Where a method stands in a list: by its family, then by its place in it."""
    family = family_of(method)
    return families().index(family), place_of(method), method


def place_of(method: str) -> int:
    """The place of a method in its family; a Butcher table has that of its method."""
    known = known_methods().get(method)
    return members_of(known.family).index(known.name) if known else 0
