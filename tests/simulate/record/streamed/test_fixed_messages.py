"""Chunks have every message once, in order of time, whatever the instants of the ports are."""

from __future__ import annotations

import random
import struct

import numpy
import pytest

from cspdiag.model.types import BOOL, DOUBLE, INT, ArrayType, Type
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap.fixed_messages import FixedChunk, FixedMessages
from cspdiag.simulate.record.streamed.mcap.messages import message_of

KINDS: tuple[Type, ...] = (DOUBLE, INT, BOOL, DOUBLE, ArrayType(DOUBLE, 2))
PERIODS = (2, 1, 0, 2, 1)


def _random_block(port: int, seed: random.Random) -> Block:
    period = PERIODS[port]
    if period:
        first, count = seed.randrange(3), seed.randrange(1, 200)
        time = numpy.arange(first, first + count) * period
        if seed.random() < 0.3:  # As an output that is not written at every tick.
            time = time[[seed.random() < 0.9 for _ in time]]
    else:
        time = numpy.array(sorted(seed.randrange(200) for _ in range(seed.randrange(1, 30))))
    time = time if len(time) else numpy.array([0])
    values = numpy.array([seed.randrange(2) if port == 2 else seed.randrange(1000) for _ in time], float)
    if port == 4:
        return Block(port, time, numpy.stack([values, -values], axis=1))
    return Block(port, time, values.astype(bool if port == 2 else "i8" if port == 1 else float))


@pytest.mark.parametrize("number", range(60))
def test_every_message_is_there_once_and_in_order(number: int) -> None:
    seed = random.Random(number)
    chosen = sorted(seed.sample(range(len(KINDS)), seed.randrange(1, len(KINDS) + 1)))
    blocks = [_random_block(port, seed) for port in chosen]
    ports = [FixedMessages(position, message_of(kind), kind) for position, kind in enumerate(KINDS)]
    chunk = FixedChunk(blocks, ports, PERIODS)
    into = numpy.full(chunk.size, 255, numpy.uint8)
    first = [10 * port for port in chosen]
    chunk.write(into, first)
    data = into.tobytes()

    place, last = 0, -1
    found: dict[int, list[tuple[int, int, int, object]]] = {port: [] for port in chosen}
    while place < len(data):
        opcode, size, channel, sequence, time, published = struct.unpack_from("<BQHIQQ", data, place)
        assert (opcode, published) == (5, time)
        assert time >= last
        body = data[place + 35 : place + 9 + size]
        code = {0: "<d", 1: "<q", 2: "<?", 3: "<d", 4: "<2d"}[channel - 1]
        found[channel - 1].append((place, sequence, time, list(struct.unpack(code, body))))
        place, last = place + 9 + size, time
    for block, start, offsets in zip(blocks, first, chunk.offsets(), strict=True):
        values = [value if isinstance(value, list) else [value] for value in block.value.tolist()]
        numbers = range(start, start + len(block.time))
        expected = list(zip(offsets.tolist(), numbers, block.time.tolist(), values, strict=True))
        assert found[block.port] == expected
