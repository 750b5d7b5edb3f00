"""What is found in a network, from what is found in the two with fewer elements that it continues."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation, IrregularError
from cspdiag.network.ir.network import Network

Found = TypeVar("Found")


def continued(search: Callable[[Network], Found]) -> Callable[[Network], Found]:
    """A search of a network that judges each element by what is around it, as passes do: what it finds, in the order
    of the rows of the network, continues as these do. If it does not, the network itself is searched.
    """

    @wraps(search)
    def result(network: Network) -> Found:
        made = network.continued
        if made is not None:
            try:
                return Extrapolation(*made.sizes).of(search(made.few), search(made.some))
            except IrregularError:
                pass
        return search(network)

    return result
