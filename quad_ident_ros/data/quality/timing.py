# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rate, gaps and duplicates in time, and what the reader had to leave out."""

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import GAP
from quad_ident_ros.data.record import CUT, FlightRecord, NOTED
from quad_ident_ros.model.vehicle import Vehicle

COARSE = 0.025    # s between samples from which on commands change unseen between them
SILENT = 0.9      # share of the time outside of bursts,
AGAIN = 0.01      # in this share of the steps at least, and
OFTEN = 10        # so many of them: of fewer each is a gap
SLOWEST = 0.15    # s between samples: of a rollout of 0.5 s hardly more than its end is then seen


def slow(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find records that are sampled too slowly to be held against rollouts."""
    period = record.period()
    if period <= COARSE:
        return []
    if period <= SLOWEST:
        return [Finding(
            'coarse', 'warning', 't',
            f'a sample every {period:.4g} s: rotors are faster, so lags, delays and moments are '
            'not determined well', f'record at {1.0 / COARSE:.0f} Hz or more')]
    return [Finding(
        'slow', 'error', 't',
        f'a sample every {period:.4g} s is too slow to see a vehicle fly; at least every '
        f'{SLOWEST:g} s is needed',
        't is in seconds: divide it by 1000 where it is in ms, by 1e6 where it is in us, by 1e9 '
        'where it is in ns, or by the rate where it counts samples; if it is right, record '
        'faster')]


def bursts(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find samples that are stamped on arrival, many at once."""
    if not _in_bursts(record):
        return []
    steps = np.diff(record.t)
    usual = float(np.median(steps))
    silence = float(np.median(steps[steps > GAP * usual]))
    return [Finding(
        'bursts', 'error', 't',
        f'the stamps come in bursts: {usual:.2g} s from one sample to the next, and between '
        f'bursts {silence:.2g} s: samples were stamped when they arrived',
        'stamp samples where they are measured, or spread the times of each burst evenly over '
        'the time before it')]


def _in_bursts(record: FlightRecord) -> bool:
    """Whether nearly all of the time passes in a few of the steps, again and again."""
    steps = np.diff(record.t)
    wide = steps > GAP * np.median(steps)
    return bool(wide.sum() >= max(OFTEN, AGAIN * len(steps))
                and steps[wide].sum() > SILENT * steps.sum())


def gaps(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find steps in time of over three median periods."""
    if _in_bursts(record):
        return []
    steps, period = np.diff(record.t), record.period()
    wide = np.flatnonzero((steps > GAP * period)
                          & ~np.isin(record.t[1:], record.info.get('cuts', ())))
    if not len(wide):
        return []
    longest = wide[np.argmax(steps[wide])]
    missing = int(np.sum(np.round(steps[wide] / period) - 1))
    share = missing / (missing + len(record))
    return [Finding(
        'gap', 'warning' if steps[longest] > 0.25 or share > 0.02 else 'info',
        f't = {record.t[longest]:.3f} s',
        f'{counted(len(wide), "gap")}, {counted(missing, "sample")} ({100 * share:.1f} %) '
        f'{"is" if missing == 1 else "are"} missing; the longest is '
        f'{steps[longest]:.3f} s',
        'predictions stop at gaps; record with a lossless transport')]


def duplicates(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find samples that repeat the one before in every column."""
    table = np.stack(list(record.columns.values()), axis=-1) if record.columns else None
    if table is None:
        return []
    same = np.all((table[1:] == table[:-1]) | (np.isnan(table[1:]) & np.isnan(table[:-1])),
                  axis=1)
    # All at rest, as in a simulation without noise, is no fault.
    moving = np.median(np.any(table[1:] != table[:-1], axis=1)) > 0
    if not same.any() or not moving or _at_rest(same):
        return []
    first = int(np.argmax(same)) + 1
    return [Finding('duplicate', 'warning', f't = {record.t[first]:.3f} s',
                    f'{counted(int(same.sum()), "sample")} with the values of the one before in '
                    'every column',
                    'keep one sample of each; a recorder that polls writes them')]


def _at_rest(same: np.ndarray) -> bool:
    """Whether all repeats lie at the beginning or the end."""
    changes = np.flatnonzero(~same)
    return not same[changes[0]:changes[-1]].any()


def truncated(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find files whose last line was left out."""
    if not record.info.get('truncated'):
        return []
    return [Finding('truncated', 'warning', 'file', CUT,
                    'if the line is whole, end it with a line end')]


def reader_notes(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Pass on what the reader took for what, and what it left out."""
    codes = {note: code for code in NOTED for note in record.info.get(code, ())}
    # What a note on anything but commands asks for, if anything, it says itself.
    return [Finding(codes.get(note, 'reader'), 'info', 'file', note,
                    'nothing to do if this is right'
                    if codes.get(note) == 'commands' else '')
            for note in record.info.get('notes', ()) if isinstance(note, str)]
