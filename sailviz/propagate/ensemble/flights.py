"""Many flights of one craft under winds of their own: BLOCK flights march in step, one in each vector lane.

All flights share start, steering and the times at which anything changes; each has its own wind and, from it and from
where it is, its own voltage. Fixed Runge-Kutta steps land on every change. What is kept is sums and histograms at the
output times, the ends of all flights, and whole histories of the first few.

Any consistent units; `sailviz.uncertainty.ensembles` uses mu = 1 and the astronomical unit. A flight depends on the
seed and its number alone, and blocks are added up in their order, so results do not depend on the number of threads.
"""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from queue import SimpleQueue
from threading import Event
from typing import Any, NamedTuple

import numpy as np

from sailviz.compiled import entry, inlined, summing
from sailviz.propagate.ensemble.draws import (
    DRAWN,
    REPLAYED,
    fill_normals,
    looked_up,
    normal_quantile,
    seed_stream,
    uniform,
)
from sailviz.propagate.ensemble.motion import MERIDIAN, PLANE, step_in_plane, step_in_space
from sailviz.propulsion import voltage_control

BLOCK = 1024  # flights that march together: state rows stay in the second-level cache, histograms are met while hot
BINS = 1024  # of a histogram, over twice the range of the first block: 0.2 % of that range each

LANES = 64  # flights are taken in whole multiples of this
LANE_STEPS = 3_000_000  # steps of all flights of a block before it comes back to Python: 0.1 s or less
SEGMENT, SUBSTEP, REDRAW = range(3)  # how far a block has come

# rows of a block's state: six of motion, see ensemble_motion; what drives it; sums over time; the wind's memory
RHO, THETA, HEIGHT, U, V, W, FACTOR, VOLTAGE, PRESSURE = range(9)
SUM_FACTOR, SUM_VOLTAGE, SUM_SATURATED, DEVIATE, LEVEL, FRESH, ROWS = range(9, 16)
SEEN = 9  # rows of which statistics are kept: those up to the pressure
_PAIRS = [(a, b) for a in range(6) for b in range(a + 1)]  # of the covariance, then the variances of the other three
MOMENTS = SEEN + len(_PAIRS) + 3 + 1  # means, these, and the share at the largest voltage

ROOT, LINEAR = 0, 1  # thrust goes with the root of the drawn quantity (wind pressure) or with itself (irradiance)


class Plan(NamedTuple):
    """What all flights share, segment by segment; nothing changes inside a segment."""

    start: np.ndarray  # (6,) rho, theta, z, u, v, w
    span: np.ndarray  # (segments,) time
    substeps: np.ndarray  # (segments,) int64, Runge-Kutta steps
    strength: np.ndarray  # (segments, 6) radial, transverse, normal acceleration at distance 1: going as 1/r, as 1/r2
    redraw: np.ndarray  # (segments,) bool, the wind changes at the start
    new_level: np.ndarray  # (segments,) bool, the slow factor on the wind changes at the start
    update: np.ndarray  # (segments,) bool, the voltage law acts at the start
    output: np.ndarray  # (segments + 1,) row of the outputs that the start of the segment (the end of all) fills, or -1
    aim: np.ndarray  # (segments, 2) distance and radial speed that the distance law leads back to
    frame: int  # PLANE, ORBITAL or MERIDIAN
    mu: float


class Wind(NamedTuple):
    """Where the pressure (or irradiance) of a flight comes from, one value for each redraw."""

    kind: int  # GIVEN: rows of `values`; DRAWN: `table` at a normal deviate; REPLAYED: `table` from a random start
    seed: int
    memory: float  # correlation of successive deviates, 0 for independent redraws
    first: float  # deviate of the table's first entry
    inverse_step: float  # entries per unit of deviate
    table: np.ndarray  # (k,)
    spread: float  # standard deviation of the logarithm of the slow factor on all of these
    values: np.ndarray  # (flights or 1, redraws or 1)
    response: int  # ROOT or LINEAR


def _numbers(wind: Wind) -> Wind:
    """A wind whose seed fits in a signed integer of 64 bits, of which the kernel takes the bits."""
    return wind._replace(seed=(wind.seed + 2**63) % 2**64 - 2**63)


class Ensemble(NamedTuple):
    """What `fly` keeps."""

    moments: np.ndarray  # (outputs, MOMENTS) sums over flights, the first of deviations from the reference
    counts: np.ndarray  # (outputs, SEEN, BINS) int64, empty if all flights are in `record`
    low: np.ndarray  # (outputs, SEEN) lower end of the histograms
    width: np.ndarray  # (outputs, SEEN) of a bin, 0 where the first block was all alike
    record: np.ndarray  # (BLOCK or fewer, outputs, SEEN) the first flights whole
    end: np.ndarray  # (flights, 6)
    mean: np.ndarray  # (flights, 3) averages over time: factor, voltage, share of time at the largest voltage


@summing
def _mean_product(a, b, a0, b0, used):
    total = 0.0
    for i in range(used):
        total += (a[i] - a0) * (b[i] - b0)
    return total


@summing
def _sum(a, a0, used):
    total = 0.0
    for i in range(used):
        total += a[i] - a0
    return total


@inlined
def _observe(s, used, o, reference, c, record, moments, low, width, counts):
    """Add the lanes to the sums, histograms and records of output o."""
    m, place = moments[o], SEEN
    for a in range(SEEN):
        m[a] += _sum(s[a], reference[o, a], used)
        for b in range(a + 1):
            if a < 6 or a == b:
                m[place] += _mean_product(s[a], s[b], reference[o, a], reference[o, b], used)
                place += 1
    if c[voltage_control.KIND] != voltage_control.CONSTANT:
        for i in range(used):
            m[place] += s[VOLTAGE, i] >= c[voltage_control.MAXIMUM]
    if counts.shape[0] > 0:
        for a in range(SEEN):
            if width[o, a] > 0.0:
                start, inverse, row, bins = low[o, a], 1.0 / width[o, a], s[a], counts[o, a]
                for i in range(used):
                    bins[int(min(max((row[i] - start) * inverse, 0.0), BINS - 1.0))] += 1
    for i in range(min(used, record.shape[0])):
        for a in range(SEEN):
            record[i, o, a] = s[a, i]


@inlined
def _redraw(s, lanes, words, begin, k, first, kind, memory, low, inverse_step, table, values):
    """The wind of redraw k."""
    fresh = np.sqrt(1.0 - memory * memory)
    pressure, deviate, level = s[PRESSURE], s[DEVIATE], s[LEVEL]
    if kind == DRAWN:
        z = s[FRESH]
        fill_normals(words, pressure, z)
        for i in range(lanes):
            deviate[i] = z[i] if k == 0 else memory * deviate[i] + fresh * z[i]
        for i in range(lanes):
            pressure[i] = level[i] * looked_up(deviate[i], low, inverse_step, table)
    elif kind == REPLAYED:
        for i in range(lanes):
            pressure[i] = level[i] * table[begin[i] + k]
    else:
        column = min(k, values.shape[1] - 1)
        for i in range(lanes):
            pressure[i] = level[i] * values[min(first + i, values.shape[0] - 1), column]


@inlined
def _control(s, lanes, aim_r, aim_u, frame, c):
    """The voltage law acts."""
    for i in range(lanes):
        r, u = s[RHO, i], s[U, i]
        if frame != PLANE:
            z = s[HEIGHT, i]
            size = np.sqrt(r * r + z * z)
            u, r = (r * u + z * s[W, i]) / size, size
        s[VOLTAGE, i] = voltage_control.voltage(s[VOLTAGE, i], s[PRESSURE, i], np.nan, r, u, aim_r, aim_u, c)


@inlined
def _drive(s, lanes, c, response):
    """Thrust factors from wind and voltage."""
    if response == LINEAR:
        inverse = 1.0 / c[voltage_control.P_REF]
        for i in range(lanes):
            s[FACTOR, i] = s[PRESSURE, i] * inverse
    else:
        for i in range(lanes):
            s[FACTOR, i] = voltage_control.thrust_factor(s[VOLTAGE, i], s[PRESSURE, i], c[voltage_control.WIND], c)


@entry("i i d1 d1 i1 d2 b1 b1 b1 i1 d2 i d i i d d d d1 d d2 i d1 d2 D3 D2 d2 d2 J3 D2 D2 D2 U2 I1 I1 D1 i")
def fly_block(
    first, used, start, span, substeps, strength, redraw, new_level, update, output, aim, frame,
    mu, kind, seed, memory, low_deviate, inverse_step, table, spread, values, response,
    c, reference, record, moments, low, width, counts, end, mean, s, words, begin, place, total, most,
):  # fmt: skip
    """Fly the flights first .. first + used - 1 from start to end, or until `most` steps are made; returns 1 if that
    was all, else 0. `Plan` and `Wind` taken apart, the row of the control law, what to subtract from the sums (outputs,
    SEEN), and the arrays of `Ensemble` to fill: record, moments and counts of this block, rows of end and mean of these
    flights. s, words, begin, place and total : what has to be known to go on, see `_Block`."""
    lanes = s.shape[1]
    # a tuple: numbers in an array would be read again for every lane, in case that writing to `s` had changed them
    law_row = (c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9], c[10], c[11])
    if place[SEGMENT] == 0 and place[SUBSTEP] == 0:
        redraws = 0
        for n in range(len(span)):
            redraws += redraw[n]
        for i in range(lanes):
            for a in range(6):
                s[a, i] = start[a]
            s[VOLTAGE, i], s[LEVEL, i] = np.nan, 1.0
            seed_stream(words, i, np.uint64(seed), np.uint64(first + i))
            if kind == REPLAYED:
                begin[i] = int(uniform(words, i) * (len(table) - redraws + 1))
    k = place[REDRAW]
    made = 0
    for n in range(place[SEGMENT], len(span) + 1):
        ended = n == len(span)  # a turn for the outputs alone: so the compiler meets their code once
        fresh = place[SUBSTEP] == 0  # or in the middle of the segment's steps
        if fresh and not ended and new_level[n]:
            for i in range(lanes):
                s[LEVEL, i] = np.exp(spread * normal_quantile(uniform(words, i)))
        if fresh and not ended and redraw[n]:
            _redraw(s, lanes, words, begin, k, first, kind, memory, low_deviate, inverse_step, table, values)
            k += 1
        if fresh and not ended and update[n]:
            _control(s, lanes, aim[n, 0], aim[n, 1], frame, law_row)
        if fresh and not ended and (redraw[n] or update[n]):
            _drive(s, lanes, law_row, response)
        if fresh and output[n] >= 0:
            _observe(s, used, output[n], reference, law_row, record, moments, low, width, counts)
        if ended:
            break
        h = span[n] / substeps[n]
        g = strength[n]
        # as many as there are, or as many as may be made before coming back
        last = min(substeps[n], place[SUBSTEP] + most - made)
        made += last - place[SUBSTEP] + 1
        for _ in range(place[SUBSTEP], last):
            if frame == PLANE:
                step_in_plane(s, s[FACTOR], lanes, h, g[0], g[1], g[3], g[4], mu)
            else:
                step_in_space(s, s[FACTOR], lanes, h, g[0], g[1], g[2], g[3], g[4], g[5], mu, frame == MERIDIAN)
        if last < substeps[n]:
            place[SEGMENT], place[SUBSTEP], place[REDRAW] = n, last, k
            return 0
        place[SUBSTEP] = 0
        total[0] += span[n]
        for i in range(lanes):
            s[SUM_FACTOR, i] += span[n] * s[FACTOR, i]
            s[SUM_VOLTAGE, i] += span[n] * s[VOLTAGE, i]
        if c[voltage_control.KIND] != voltage_control.CONSTANT:
            for i in range(lanes):
                s[SUM_SATURATED, i] += span[n] if s[VOLTAGE, i] >= c[voltage_control.MAXIMUM] else 0.0
        if made >= most:
            place[SEGMENT], place[REDRAW] = n + 1, k
            return 0
    for i in range(used):
        for a in range(6):
            end[i, a] = s[a, i]
        for a in range(3):
            mean[i, a] = s[SUM_FACTOR + a, i] / total[0]
    return 1


class _Block:
    """What is remembered of a block of flights between two pieces of their way. Compiled code is deaf: it comes back
    after about 0.1 s, so that Ctrl-C is heard and threads can be told to stop."""

    def __init__(self, used: int) -> None:
        lanes = (used + LANES - 1) // LANES * LANES  # whole vectors, the last ones idle
        self.memory = (
            np.zeros((ROWS, lanes)),
            np.empty((4, lanes), np.uint64),
            np.zeros(lanes, np.int64),
            np.zeros(3, np.int64),  # SEGMENT, SUBSTEP, REDRAW
            np.zeros(1),  # time so far
        )
        self.most = max(1, LANE_STEPS // lanes)

    def fly(self, *arguments, stop: Event | None = None) -> None:
        """All of the way; `fly_block` says what the arguments are. stop : ends it before, where set."""
        while not fly_block(*arguments, *self.memory, self.most):
            if stop is not None and stop.is_set():
                return


_NO_COUNTS = np.zeros((0, SEEN, BINS), np.int32)


def record_flights(plan: Plan, wind: Wind, control, flights, reference=None):
    """An Ensemble of at most BLOCK flights, all of them in its record. reference as in `fly`."""
    outputs = int(plan.output.max()) + 1
    blank = np.zeros((outputs, SEEN))
    record, moments = np.empty((flights, outputs, SEEN)), np.zeros((outputs, MOMENTS))
    end, mean = np.empty((flights, 6)), np.empty((flights, 3))
    reference = blank if reference is None else reference
    arguments = (
        0,
        flights,
        *plan,
        *_numbers(wind),
        control,
        reference,
        record,
        moments,
        blank,
        blank,
        _NO_COUNTS,
        end,
        mean,
    )
    _Block(flights).fly(*arguments)
    return Ensemble(moments, _NO_COUNTS, blank, blank, record, end, mean)


def fly(plan: Plan, wind: Wind, control, reference, flights, threads=1, progress=None) -> Ensemble:
    """Fly an ensemble. control : row of `sailviz.propulsion.voltage_control`, its MU in the units of the plan;
    reference (outputs, SEEN) : values near the means, subtracted before squares are summed. progress : called with the
    number of flights done."""
    outputs = len(reference)
    head = record_flights(plan, wind, control, min(flights, BLOCK), reference)
    if flights <= BLOCK:
        return head
    least, most = head.record.min(axis=0), head.record.max(axis=0)
    low, width = least - 0.5 * (most - least), 2.0 * (most - least) / BINS
    end, mean = np.empty((flights, 6)), np.empty((flights, 3))
    total = np.zeros((outputs, MOMENTS))
    shelf: SimpleQueue[np.ndarray[Any, Any]] = SimpleQueue()  # of histograms, one for each thread
    for _ in range(threads):
        shelf.put(np.zeros((outputs, SEEN, BINS), np.int32))
    nothing = np.empty((0, outputs, SEEN))
    stop = Event()

    def block(first):
        used = min(BLOCK, flights - first)
        moments, counts = np.zeros((outputs, MOMENTS)), shelf.get()
        part = slice(first, first + used)
        arguments = first, used, *plan, *_numbers(wind), control, reference, nothing, moments, low, width, counts
        _Block(used).fly(*arguments, end[part], mean[part], stop=stop)
        shelf.put(counts)
        return moments

    with ThreadPoolExecutor(threads) as pool:
        waiting: deque[Future[np.ndarray[Any, Any]]] = deque()
        ahead = iter(range(0, flights, BLOCK))
        done = 0
        try:
            while True:
                while len(waiting) < 2 * threads and (first := next(ahead, None)) is not None:
                    waiting.append(pool.submit(block, first))
                if not waiting:
                    break
                total += waiting.popleft().result()  # in order of flights, whoever finished first
                done = min(done + BLOCK, flights)
                if progress:
                    progress(done)
        except BaseException:  # Ctrl-C: the threads come to their end at once
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    counts = np.zeros((outputs, SEEN, BINS), np.int64)
    for _ in range(threads):
        counts += shelf.get()
    return Ensemble(total, counts, low, width, head.record, end, mean)


def covariance(moments, flights):
    """Means minus reference (outputs, SEEN), covariance of the motion (outputs, 6, 6) and standard deviations of the
    other three (outputs, 3), with flights - 1 in the denominator (0 for a single flight)."""
    mean = moments[:, :SEEN] / flights
    scale = flights / max(flights - 1, 1)
    cov = np.empty((len(moments), 6, 6))
    for place, (a, b) in enumerate(_PAIRS):
        value = scale * (moments[:, SEEN + place] / flights - mean[:, a] * mean[:, b])
        cov[:, a, b] = cov[:, b, a] = value
    others = scale * (moments[:, SEEN + len(_PAIRS) : -1] / flights - mean[:, 6:SEEN] ** 2)
    return mean, cov, np.sqrt(np.maximum(others, 0.0))


def percentiles(ensemble: Ensemble, levels):
    """(levels, outputs, SEEN). Exact where all flights are recorded; else read from the histograms, to a bin's width at
    worst, and no further out than half the range of the first block beyond its ends."""
    if not len(ensemble.counts):
        return np.percentile(ensemble.record, levels, axis=0)
    below = np.concatenate([np.zeros((*ensemble.counts.shape[:2], 1)), np.cumsum(ensemble.counts, axis=2)], axis=2)
    out = np.empty((len(levels), *ensemble.low.shape))
    for o in range(len(ensemble.low)):
        for a in range(SEEN):
            out[:, o, a] = ensemble.low[o, a]
            if ensemble.width[o, a] > 0:
                wanted = np.asarray(levels) / 100 * below[o, a, -1]
                out[:, o, a] += ensemble.width[o, a] * np.interp(wanted, below[o, a], np.arange(BINS + 1))
    return out
