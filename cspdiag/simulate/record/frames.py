"""Recordings as tables of pandas and data sets of xarray, with units and periods; both packages are imported when they
are needed.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.base.errors import missing_package
from cspdiag.base.record import record
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.simulate.record.held import Column, columns_of, held_rows
from cspdiag.simulate.record.run_data import histories

if TYPE_CHECKING:
    import numpy
    import pandas
    import xarray

    from cspdiag.simulate.record.run_data import RunData


@record
class _Channel:
    """A signal to be put into a table; ``period`` in seconds."""

    path: str
    name: str
    type: Type
    period: float | None


def to_dataframe(run: RunData, names: Iterable[str]) -> pandas.DataFrame:
    """See ``Run.to_dataframe``."""
    try:
        import pandas
    except ImportError:
        raise missing_package("pandas", "pandas") from None
    channels = _channels(run, names)
    columns = [column for channel in channels for column in _columns(channel)]
    times, cells = _held(run, columns)
    frame = pandas.DataFrame(
        {column.name: _series(values, column.type) for column, values in zip(columns, cells, strict=True)},
        index=pandas.Index(times, name="time", dtype=float),
    )
    periods = {channel.path: channel.period for channel in channels}
    frame.attrs = _attributes(run) | {
        "units": {"time": "s"} | {column.name: unit for column in columns if (unit := _unit(column.type)) is not None},
        "periods": {column.name: period for column in columns if (period := periods[column.channel]) is not None},
    }
    return frame


def to_xarray(run: RunData, names: Iterable[str]) -> xarray.Dataset:
    """See ``Run.to_xarray``."""
    try:
        import xarray
    except ImportError:
        raise missing_package("xarray", "xarray") from None
    variables: dict[str, tuple[tuple[str, ...], numpy.ndarray, dict[str, object]]] = {}
    channels = _channels(run, names)
    columns = [_columns(channel) for channel in channels]
    times, cells = _held(run, [column for own in columns for column in own])
    position = 0
    for channel, own in zip(channels, columns, strict=True):
        found = [_array(cells[position + k], column.type) for k, column in enumerate(own)]
        position += len(own)
        shape = _shape(channel.type)
        if shape is None:
            for column, values in zip(own, found, strict=True):
                variables[column.name] = ("time",), values, _of_variable(column.type, channel.period)
            continue
        dimensions = [f"{channel.name}_{axis}" for axis in range(len(shape))]
        import numpy

        stacked = numpy.stack(found, axis=-1) if found else numpy.empty((len(times), 0))
        variables[channel.name] = (
            ("time", *dimensions), stacked.reshape(len(times), *shape),
            _of_variable(own[0].type if own else channel.type, channel.period)
        )  # fmt: skip
    coordinates = {"time": (("time",), times, {"units": "s"})}
    return xarray.Dataset(variables, coords=coordinates, attrs=_attributes(run))


def _attributes(run: RunData) -> dict[str, object]:
    environment = {} if run.environment is None else {"environment": run.environment.name}
    return {"process": run.network.top, **environment, "ended": run.outcome.ended}


def _channels(run: RunData, names: Iterable[str]) -> list[_Channel]:
    """The channels of signals; the signals are known."""
    prefix = f"{run.network.top}."
    ports = {port.name: port for port in run.network.external_ports}
    nets = {net.path: net for net in run.network.nets}
    found = []
    for name in names:
        port = ports.get(name)
        declared = port if port is not None else nets[name]
        period = None if declared.sampling is None else declared.sampling.period / 1e9
        found.append(_Channel(name if port is None else f"{prefix}{name}", name, declared.type, period))
    return found


def _columns(channel: _Channel) -> list[Column[object]]:
    return columns_of(channel.path, channel.name, channel.type, lambda values, _: values)


def _held(run: RunData, columns: list[Column[object]]) -> tuple[numpy.ndarray, list[list[Any]]]:
    """Instants in seconds, and the cells of each column, None before the first value."""
    import numpy

    times: list[float] = []
    found: list[list[object]] = [[] for _ in columns]
    for instants, cells in held_rows(histories(run), columns, None):
        times += [instant / 1e9 for instant in instants]
        for own, part in zip(found, cells, strict=True):
            own += part
    return numpy.array(times, dtype=float), found


def _series(values: list[Any], kind: Type) -> Any:
    """A column of a nullable type of pandas, with missing cells before the first value; enum literals by name."""
    import pandas

    match kind:
        case EnumType(literals=literals):
            codes = [-1 if value is None else int(value) for value in values]
            return pandas.Categorical.from_codes(codes, categories=list(literals))
        case BoolType():
            return pandas.array(values, dtype="boolean")
        case IntType() | TimeType():
            return pandas.array(values, dtype="Int64")
        case RealType():
            return pandas.array([float("nan") if value is None else value for value in values], dtype="float64")
        case TextType() | StructType() | ArrayType() | UnknownType():
            return values
        case _:
            assert_never(kind)


def _array(values: list[Any], kind: Type) -> numpy.ndarray:
    """A column of numbers: floats if a value is missing, since numpy has no other way to show that."""
    import numpy

    if any(value is None for value in values):
        return numpy.array([float("nan") if value is None else value for value in values], dtype=float)
    match kind:
        case BoolType():
            return numpy.array(values, dtype=bool)
        case IntType() | TimeType() | EnumType():
            return numpy.array(values, dtype="i8")
        case RealType() | TextType() | StructType() | ArrayType() | UnknownType():
            return numpy.array(values, dtype=float)
        case _:
            assert_never(kind)


def _shape(kind: Type) -> tuple[int, ...] | None:
    """The axes of an array of numbers; None for a single number, and for structs, whose numbers have names."""
    sizes: list[int] = []
    while isinstance(kind, ArrayType):
        sizes.append(kind.size or 0)
        kind = kind.element
    return tuple(sizes) if sizes and isinstance(kind, BoolType | IntType | RealType | TimeType | EnumType) else None


def _unit(kind: Type) -> str | None:
    match kind:
        case RealType(unit=unit):
            return str(unit)
        case TimeType():
            return "ns"
        case BoolType() | IntType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType():
            return None
        case _:
            assert_never(kind)


def _of_variable(kind: Type, period: float | None) -> dict[str, object]:
    """The attributes of a variable, named by the CF conventions where those have a name."""
    found: dict[str, object] = {"type": str(kind)}
    unit = _unit(kind)
    if unit is not None:
        found["units"] = unit
    if period is not None:
        found["period"] = period
    if isinstance(kind, EnumType):
        found |= {"flag_values": list(range(len(kind.literals))), "flag_meanings": " ".join(kind.literals)}
    return found
