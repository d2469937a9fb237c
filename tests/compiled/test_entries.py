"""What Python hands to compiled code arrives as it is, or is refused; and a C function is one, whoever compiles it."""

from __future__ import annotations

import ctypes
import pickle

import numpy as np
import pytest
from numba import carray, types

from sailviz.compiled import c_function, entries, entry
from sailviz.compiled.entries import Entry, Kind

RECORD = np.dtype([("a", np.float64), ("n", np.int64)], align=True)
CALLED = types.void(types.float64, types.CPointer(types.float64))


@entry("d2 I1 r1 u1 b1 j1 d i D1", RECORD)
def gathered(doubles, whole, records, words, flags, small, number, count, out):
    out[0], out[1], out[2] = doubles.shape[0], doubles.shape[1], doubles[1, 2]
    out[3], out[4], out[5] = records[0].a, records[0].n, number
    out[6], out[7], out[8] = flags[1], small[0], words[0] >> np.uint64(60)
    whole[0] = count
    return len(out)


@entry("d1 D1 d i")
def scaled(x, out, factor, first):
    for i in range(first, len(x)):
        out[i] = factor * x[i]
    return len(x)


@pytest.fixture(params=["loaded", "by numba"])
def called(request, monkeypatch):
    """An entry as it is, and as it is where memory lies otherwise than compiled code expects."""

    def made(known):
        one = Entry(known.py_func, " ".join(kind.word for kind in known.kinds), RECORD)
        assert (one.native is None) == (request.param == "by numba")
        return one

    if request.param == "by numba":
        monkeypatch.setattr(entries, "_memory_is_as_expected", lambda: False)
    return made


def test_every_kind_of_argument_arrives(called):
    out, whole, records = np.zeros(9), np.zeros(2, np.int64), np.array([(0.25, -7)], RECORD)
    words, flags, small = np.array([2**63], np.uint64), np.array([False, True]), np.array([-5], np.int32)
    doubles = np.arange(6.0).reshape(2, 3)
    arguments = doubles, whole, records, words, flags, small, np.float64(1.5), 2**62 + 1, out
    assert called(gathered)(*arguments) == 9
    assert out.tolist() == [2, 3, 5, 0.25, -7, 1.5, 1, -5, 8]
    assert whole.tolist() == [2**62 + 1, 0]  # to the last bit, beyond what a float holds


def test_what_does_not_fit_is_refused_and_nothing_is_touched(called):
    x, out = np.arange(4.0), np.zeros(4)
    frozen = np.zeros(4)
    frozen.flags.writeable = False
    wrong = [
        (x.astype(np.float32), out), (np.arange(4), out), (x[::2], out), (x[None], out), ([1.0, 2.0], out), (None, out),
        (x, frozen), (x.astype(">f8"), out), (np.ma.masked_array(x), out), (np.frombuffer(bytes(33), offset=1), out),
        (x, 3), (x, np.zeros(4, RECORD)), ("text", out), (x, out.astype(complex)),
    ]  # fmt: skip
    function = called(scaled)
    for arguments in wrong:
        with pytest.raises(TypeError, match=r"scaled does not take .* as argument [12], [dD]1"):
            function(*arguments, 1.0, 0)
    for numbers in ((1.0, 0.5), (None, 0), (1.0, "0")):
        with pytest.raises(Exception, match=r"."):
            function(x, out, *numbers)
    with pytest.raises(TypeError, match="4 arguments, not 3"):
        function(x, out, 1.0)
    assert not out.any()
    x.flags.writeable = False  # what is only read may be
    assert function(x, out, 2, 1) == 4
    assert out.tolist() == [0, 2, 4, 6]
    for two in (2.0, np.float64(2.0), np.float32(2.0), np.int64(2), np.array(2.0), True + 1):
        out[:] = 0.0
        assert function(x, out, two, 0) == 4
        assert out.tolist() == [0, 2, 4, 6]


def test_arrays_that_went_through_another_process_fit(called):
    x = pickle.loads(pickle.dumps(np.arange(3.0)))
    out = np.zeros(3)
    called(scaled)(x, out, 3.0, 0)
    assert out.tolist() == [0, 3, 6]


@pytest.mark.parametrize("words", ["d2 x", "D", "r1", "d-1", "u", "1d"])
def test_kinds_that_there_are_not_are_refused(words):
    with pytest.raises(ValueError, match="there is no kind"):
        entry(words)(scaled.py_func)
    assert Kind("R1", RECORD).written


def by_numba(number, out):
    """With counted references, which numba alone has."""
    carray(out, (1,))[0] = 3.0 * number


def raising(number, out):
    if number > 1.0:
        raise ValueError("too large")


def test_functions_called_by_address_are_one_whoever_compiles_them():
    for function in (by_numba, raising):
        address, alive = c_function(function, lambda: CALLED)
        assert address
        native = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p)
        out, answer = ctypes.c_double(0.0), (ctypes.c_int64 * 2)()
        at = ctypes.addressof(answer)
        status = native(address)(at, at + 8, 2.0, ctypes.addressof(out))
        assert (status != 0, out.value) == ((False, 6.0) if function is by_numba else (True, 0.0))
        assert alive is not None
