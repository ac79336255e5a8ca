"""Decimation for the screen."""

import numpy as np

from limber.monitor.bins import Bins


def test_a_spike_of_one_sample_stays():
    bins = Bins(width_s=0.1, count=100, series=2)
    t = np.arange(0.0, 10.0, 0.001)
    values = np.vstack([np.zeros_like(t), np.sin(t)])
    values[0, 4321] = 50.0
    for part in np.array_split(np.arange(len(t)), 37):  # as batches come
        bins.add(t[part], values[:, part])
    shown_t, curves = bins.curves()
    assert len(shown_t) == 200
    assert curves[0].max() == 50.0
    assert abs(shown_t[np.argmax(curves[0])] + 10.0 - 4.3) < 0.11
    assert np.all(np.diff(shown_t) > 0)
    assert np.isclose(curves[1].max(), 1.0, atol=1e-6)
    assert np.isclose(curves[1].min(), -1.0, atol=1e-6)


def test_old_values_leave_and_gaps_are_left_out():
    bins = Bins(width_s=1.0, count=10, series=1)
    bins.add(np.array([0.5, 1.5]), np.array([[7.0, 8.0]]))
    bins.add(np.array([12.5]), np.array([[9.0]]))
    t, curves = bins.curves()
    assert curves.tolist() == [[9.0, 9.0]]
    assert t[0] == -1.0
    bins.add(np.array([5.5]), np.array([[3.0]]))  # late, still within the ring
    assert bins.curves()[1].tolist() == [[3.0, 3.0, 9.0, 9.0]]
    bins.add(np.array([1.0]), np.array([[1.0]]))  # too late
    assert bins.curves()[1].min() == 3.0


def test_what_is_not_finite_leaves_no_mark():
    bins = Bins(width_s=1.0, count=4, series=2)
    values = np.array([[np.nan, 2.0, np.inf], [1.0, np.nan, np.nan]])
    bins.add(np.array([0.1, 0.2, 1.1]), values)
    t, curves = bins.curves()
    assert len(t) == 2, "the bin without any finite value is left out"
    assert curves.tolist() == [[2.0, 2.0], [1.0, 1.0]]


def test_nothing_yet():
    t, curves = Bins(1.0, 4, 3).curves()
    assert len(t) == 0 and curves.shape == (3, 0)
