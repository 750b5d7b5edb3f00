"""The memory that a program needs: which sizes the C compiler has to report, and how they add up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from cspdiag.base.record import record
from cspdiag.codegen.c.package.package import lowered_for_c
from cspdiag.codegen.c.text.media import Access, access_of
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.network.elaborate.fewer.rows import counted, examples
from cspdiag.network.ir.network import CoreNetwork, LocalChannel, ProcessClass, SubmodelClass

PREFIX = "csp_size_"
"""The prefix of the symbols that measure sizes; each is an array with as many bytes as the type that it measures."""

_CHANNELS: Mapping[Access, str] = {
    "channel": "csp_channel",
    "guarded": "csp_guarded_channel",
    "any": "csp_any_channel",
    "broadcast": "csp_broadcast",
    "buffer": "csp_buffer",
}


@record
class ClassSize:
    """The number of instances of a class, and the bytes of one without the instances and channels inside it."""

    kind: str
    name: str
    count: int
    bytes: int


@record
class Sizes:
    """Classes of processes and control laws, the bytes and the number of channels; the bytes of an instance, which has
    all state, ports and hooks, and of the memory that its user gives.
    """

    classes: tuple[ClassSize, ...]
    channels: int
    channel_bytes: int
    instance: int
    memory: int
    memory_name: str
    """The macro with the bytes of the memory."""


class SizeMeasurement:
    """Measures the sizes of a program at an optimization level, by way of a C file that the compiler is given."""

    def __init__(self, network: CoreNetwork, level: int) -> None:
        self._network = lowered_for_c(network, level)
        self._names = PackageNames(self._network)
        self._types = CTypes(self._names)

    def source(self) -> str:
        """The C file, with an array for each type to be measured. Only the source of the interface, which it includes,
        defines an instance.
        """
        names = sorted({self._names.classes[entry.name] for entry in self._network.classes})
        rows = [f'#include "{self._names.prefix}_api.c"', '#include "csp.h"']
        rows += [*(f'#include "{name}.h"' for name in names), ""]
        rows += [f"char {PREFIX}class_{name}[sizeof(struct {name})];" for name in names]
        rows += [f"char {PREFIX}channel_{access}[sizeof({struct})];" for access, struct in _CHANNELS.items()]
        kinds = {self._types.type_name(item.type): self._types.suffix(item.type) for item in self._buffers()}
        rows += [f"char {PREFIX}value_{suffix}[sizeof({kind})];" for kind, suffix in sorted(kinds.items())]
        rows += [f"char {PREFIX}instance[sizeof(struct {self._names.prefix}_instance)];"]
        rows += [f"char {PREFIX}memory[{self._memory_name}];"]
        return "\n".join([*rows, ""])

    @property
    def _memory_name(self) -> str:
        return f"{self._names.prefix}_SIZE".upper()

    def _buffers(self) -> list[LocalChannel]:
        classes = [entry for entry in self._network.classes if isinstance(entry, ProcessClass)]
        return [item for entry in classes for item in examples(entry.channels) if access_of(item) == "buffer"]

    def sizes(self, sizes: Mapping[str, int]) -> Sizes:
        """The sizes of the program, from those of the symbols, by name without the prefix."""
        counts: Counter[str] = Counter()
        for instance, _, number in counted(self._network.instances):
            counts[instance.class_name] += number
        found: list[ClassSize] = []
        channels = channel_bytes = 0
        for entry in self._network.classes:
            count = counts[entry.name]
            if not count:
                continue
            whole = sizes[f"class_{self._names.classes[entry.name]}"]
            inside, (number, own) = self._inside(entry, sizes), self._channels(entry, sizes)
            channels += count * number
            channel_bytes += count * own
            kind = "process" if isinstance(entry, ProcessClass) else "law"
            found.append(ClassSize(kind, entry.definition, count, max(whole - inside - own, 0)))
        return Sizes(tuple(found), channels, channel_bytes, sizes["instance"], sizes["memory"], self._memory_name)

    def _inside(self, entry: ProcessClass | SubmodelClass, sizes: Mapping[str, int]) -> int:
        if not isinstance(entry, ProcessClass):
            return 0
        classes = self._names.classes
        return sum(number * sizes[f"class_{classes[item.class_name]}"] for item, _, number in counted(entry.instances))

    def _channels(self, entry: ProcessClass | SubmodelClass, sizes: Mapping[str, int]) -> tuple[int, int]:
        """The number of the channels of a class, and their bytes."""
        channels = size = 0
        for first, last, number in counted(entry.channels) if isinstance(entry, ProcessClass) else ():
            access = access_of(first)
            if access in _CHANNELS:
                channels += number
                size += number * sizes[f"channel_{access}"]
            if access == "buffer":
                places = number * ((first.capacity or 0) + (last.capacity or 0)) // 2
                size += places * sizes[f"value_{self._types.suffix(first.type)}"]
        return channels, size
