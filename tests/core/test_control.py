# SPDX-License-Identifier: GPL-3.0-or-later
"""Control, InputError and Cancelled of the native module."""

from realmodel import _native


def test_a_new_control_has_nothing_done():
    control = _native.Execution()
    assert (control.fraction, control.text, control.cancelled) == (0.0, "", False)


def test_cancel_stays():
    control = _native.Execution()
    control.cancel()
    assert control.cancelled


def test_refused_input_is_a_value_error_and_cancelling_is_none():
    assert issubclass(_native.InputError, ValueError)
    assert not issubclass(_native.Cancelled, ValueError)
