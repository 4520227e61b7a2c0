# SPDX-License-Identifier: MIT
"""Calibrated kinematics on NumPy arrays, computed by the library that runs in the controller: the same bits.

    import mdhcal, numpy
    arm = mdhcal.load("calibration.blob")
    q = numpy.zeros((100000, arm.joint_count))           # readings [rad], prismatic joints [m]; a row a configuration
    poses = arm.forward(q).pose                          # [rows, 7]: quaternion w, x, y, z, then position [m]
    there = arm.inverse(poses, q + 0.01)                 # there.q, there.status

Arrays have the shapes that are stated, with any number of axes in front ("..."); inputs are converted to double and results
are double. Where a function has a status a row, a row whose status is not usable is NaN. A call releases the interpreter's
lock while it computes. A CalibratedArm is constant and shared by threads; a Compensator belongs to one of them.
"""
from __future__ import annotations

import ctypes
import dataclasses
import enum
import os
from typing import Any, Callable, NamedTuple, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _library
from ._library import MAX_JOINTS, MAX_SOLUTIONS, MAX_TARGETS

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]

_lib = _library.load()
_REPORT = np.dtype([(name, kind) for name, kind in _library.TickReport._fields_], align=True)

__all__ = ["CalibratedArm", "Compensator", "Forward", "Inverse", "Joint", "MAX_JOINTS", "MAX_SOLUTIONS", "MAX_TARGETS",
           "Model", "Provenance", "Refused", "Solutions", "Status", "Task", "TickOptions", "check_environment", "invert",
           "load", "matrix", "multiply", "usable"]


class Status(enum.IntEnum):
    """What a function reports: the numbers of mdhcal.h."""

    OK = 0
    STEP_LIMITED = 1
    JOINT_LIMITED = 2
    NEAR_SINGULAR = 3
    OUT_OF_REACH = 4
    NOT_CONVERGED = 5
    BAD_INPUT = 6
    BAD_ENVIRONMENT = 7
    BLOB_MAGIC = 16
    BLOB_VERSION = 17
    BLOB_SIZE = 18
    BLOB_LAYOUT = 19
    BLOB_CRC = 20
    BLOB_SERIAL = 21
    BLOB_VALUE = 22
    BLOB_RESERVED = 23
    BLOB_DEVIATION = 24
    BLOB_UNSIGNED = 25
    BLOB_SIGNATURE = 26
    BLOB_COUNTER = 27
    SELF_TEST_FAILED = 28
    SELF_TEST_TOLERANCE = 29
    FLASH_READ = 48
    FLASH_PROGRAM = 49
    FLASH_ERASE = 50
    FLASH_VERIFY = 51
    FLASH_GEOMETRY = 52
    STORE_EMPTY = 53
    STORE_UNREADABLE = 54

    @property
    def text(self) -> str:
        """The status in words."""
        return bytes(_lib.mdhcal_status_text(self)).decode()


class Model(enum.IntEnum):
    """Which geometry of the arm."""

    NOMINAL = 0
    CORRECTED = 1


class Task(enum.IntEnum):
    """Which part of a pose an inverse has to meet."""

    POSE = 0
    POSITION = 1
    POSITION_AXIS = 2
    PLANAR = 3


class Refused(ValueError):
    """A blob, a compensator or options that the library does not take; `status` says why."""

    def __init__(self, what: str, status: Status) -> None:
        super().__init__(f"{what}: {status.text}.")
        self.status = status


class Joint(NamedTuple):
    """Kind of a joint, and its limits [rad], or [m] if it slides; None without one."""

    slides: bool
    min: Optional[float]
    max: Optional[float]


class Provenance(NamedTuple):
    """Where a calibration comes from; None where the blob does not say. Held-out position errors in metres."""

    tool_version: str
    date: str
    method: str
    lambda_rule: str
    measurements_sha256: Optional[str]
    pose_count: Optional[int]
    held_out_count: Optional[int]
    lambda_: Optional[float]
    mean_before_m: Optional[float]
    max_before_m: Optional[float]
    mean_after_m: Optional[float]
    max_after_m: Optional[float]


class Forward(NamedTuple):
    pose: Floats      #: base_T_flange [..., 7]
    status: Integers  #: [...]


class ForwardJacobian(NamedTuple):
    pose: Floats      #: base_T_flange [..., 7]
    jacobian: Floats  #: [..., 6, joints]: velocity [m/s], then angular velocity [rad/s] of the flange, in base axes
    status: Integers  #: [...]


class Inverse(NamedTuple):
    q: Floats                           #: [..., joints]
    status: Integers                    #: [...]
    report: npt.NDArray[np.void]        #: [...], fields as mdhcal_tick_report
    command: Optional[Floats] = None    #: poses to command [..., 7], of poses_to_poses() only


class Solutions(NamedTuple):
    count: Integers   #: [...]
    q: Floats         #: [..., 16, joints], nearest to the posture first; NaN beyond count
    distance: Floats  #: [..., 16]: largest joint difference from the posture; NaN beyond count
    status: Integers  #: [...]


@dataclasses.dataclass
class TickOptions:
    """What one tick may do, as mdhcal_tick_options; CalibratedArm.tick_options() has the defaults."""

    position_tolerance_m: float
    rotation_tolerance_rad: float
    position_weight: float
    rotation_weight: float
    max_step: Floats    #: [8]: [rad] or [m] a tick
    posture_q: Floats   #: [8]: where joints that the task leaves free should go
    posture_gain: float
    max_iterations: int
    task: Task = Task.POSE

    def _c(self) -> Any:
        goal = _library.GoalOptions(self.position_tolerance_m, self.rotation_tolerance_rad, self.position_weight,
                                    self.rotation_weight, int(self.task))
        return _library.TickOptions(goal, _eight(self.max_step), _eight(self.posture_q), self.posture_gain,
                                    self.max_iterations)


def usable(status: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """Whether what was asked for may be used, for each status: after a tick the joints, which keep their limits."""
    numbers = np.asarray(status)
    return ((numbers >= Status.OK) & (numbers <= Status.NOT_CONVERGED)) | (numbers == Status.SELF_TEST_TOLERANCE)


def check_environment() -> Status:
    """Whether this thread's processor state gives the library's bits: OK or BAD_ENVIRONMENT."""
    return Status(_lib.mdhcal_check_environment())


def multiply(a_T_b: npt.ArrayLike, b_T_c: npt.ArrayLike) -> Floats:
    """a_T_c [..., 7] of poses [..., 7], row by row or one with many. NaN where an argument is not a pose."""
    first, second = np.broadcast_arrays(_rows(a_T_b, 7, "a_T_b"), _rows(b_T_c, 7, "b_T_c"))
    shape = first.shape
    first, second = np.ascontiguousarray(first), np.ascontiguousarray(second)
    out, status = np.empty(shape), np.empty(shape[:-1], np.int32)
    _lib.mdhcal_multiply_rows(status.size, _at(first), _at(second), _at(out), _at(status))
    return out


def invert(a_T_b: npt.ArrayLike) -> Floats:
    """b_T_a [..., 7] of poses [..., 7]. NaN where an argument is not a pose."""
    pose = _rows(a_T_b, 7, "a_T_b")
    out, status = np.empty(pose.shape), np.empty(pose.shape[:-1], np.int32)
    _lib.mdhcal_invert_rows(status.size, _at(pose), _at(out), _at(status))
    return out


def matrix(pose: npt.ArrayLike) -> Floats:
    """Homogeneous matrices [..., 4, 4] of poses [..., 7]."""
    rows = _rows(pose, 7, "pose")
    w, x, y, z = np.moveaxis(rows[..., :4], -1, 0)
    out = np.zeros(rows.shape[:-1] + (4, 4))
    out[..., 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1)
    out[..., 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1)
    out[..., 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)
    out[..., :3, 3] = rows[..., 4:]
    out[..., 3, 3] = 1
    return out


def load(blob: Union[bytes, str, "os.PathLike[str]"], *, serial: Optional[str] = None,
         verify: Optional[Callable[[bytes, bytes], bool]] = None, minimum_counter: int = 0) -> CalibratedArm:
    """Loads a blob from its bytes or its file: decoded, checked, self-tested on this machine.

    serial: what the blob must be made for. verify(message, signature): whether the signature [64] is the message's; an
    exception of it is a refusal. minimum_counter: the least security counter. Raises Refused, or OSError for the file.
    """
    if isinstance(blob, bytes):
        data = blob
    else:
        with open(blob, "rb") as file:
            data = file.read(_library.BLOB_BYTES + 1)

    def judge(message: Any, size: int, signature: Any, _: Any) -> int:
        try:
            return 1 if verify is not None and verify(ctypes.string_at(message, size), ctypes.string_at(signature, 64)) else 0
        except Exception:  # it cannot pass through C
            return 0

    demands = _library.Demands(None if serial is None else serial.encode(),
                               _library.VERIFY(judge) if verify is not None else _library.VERIFY(), None, minimum_counter)
    storage = _storage(0)
    status = Status(_lib.mdhcal_load(storage, ctypes.sizeof(storage), _library.ABI_VERSION, data, len(data),
                                     ctypes.addressof(demands)))
    if not usable(status):
        raise Refused("blob" if isinstance(blob, bytes) else os.fspath(blob), status)
    return CalibratedArm(storage, status)


class CalibratedArm:
    """A calibrated arm, from load(). Constant."""

    def __init__(self, storage: Any, status: Status) -> None:
        self._storage = storage
        self.status = status  #: OK, or SELF_TEST_TOLERANCE: the blob was written by a library with other bits
        self.joint_count: int = _lib.mdhcal_joint_count(storage)
        text = _library.Description()
        _lib.mdhcal_describe(storage, ctypes.addressof(text))
        self.name: str = text.name.decode()
        self.serial: str = text.serial.decode()
        self.security_counter: int = text.security_counter
        #: target points in the flange frame [3], by name
        self.targets = {point.name.decode(): np.array(point.flange_p_m) for point in text.target[:text.target_count]}
        #: base frame in the frame of the measurements [7], or None
        self.tracker_T_base: Optional[Floats] = (
            np.array([*text.tracker_T_base_quaternion, *text.tracker_T_base_position_m]) if text.has_base else None)
        past = text.provenance
        measured, held_out = bool(past.has_measurements), bool(past.has_held_out)
        errors = [getattr(past, name) if held_out else None
                  for name in ("mean_before_m", "max_before_m", "mean_after_m", "max_after_m")]
        self.provenance = Provenance(
            past.tool_version.decode(), past.date.decode(), past.method.decode(), past.lambda_rule.decode(),
            bytes(past.measurements_sha256).hex() if measured else None, past.pose_count if measured else None,
            past.held_out_count if held_out else None, past.lambda_ if past.has_lambda else None, *errors)
        self.joints: Tuple[Joint, ...] = tuple(self._joint(index) for index in range(self.joint_count))

    def _joint(self, index: int) -> Joint:
        joint = _library.Joint()
        _lib.mdhcal_describe_joint(self._storage, index, ctypes.addressof(joint))
        return Joint(bool(joint.slides), joint.min if joint.has_min else None, joint.max if joint.has_max else None)

    def forward(self, q: npt.ArrayLike, model: Model = Model.CORRECTED) -> Forward:
        """base_T_flange at readings q [..., joints]. BAD_INPUT: a reading is not finite or out of range."""
        rows = _rows(q, self.joint_count, "q")
        pose, status = np.empty(rows.shape[:-1] + (7,)), np.empty(rows.shape[:-1], np.int32)
        _lib.mdhcal_forward_rows(self._storage, Model(model), status.size, _at(rows), _at(pose), None, _at(status))
        return Forward(pose, status)

    def jacobian(self, q: npt.ArrayLike, model: Model = Model.CORRECTED) -> ForwardJacobian:
        """forward() and the Jacobian of the flange."""
        rows = _rows(q, self.joint_count, "q")
        pose, status = np.empty(rows.shape[:-1] + (7,)), np.empty(rows.shape[:-1], np.int32)
        columns = np.empty(rows.shape + (6,))
        _lib.mdhcal_forward_rows(self._storage, Model(model), status.size, _at(rows), _at(pose), _at(columns), _at(status))
        return ForwardJacobian(pose, columns.swapaxes(-1, -2), status)

    def link_frames(self, q: npt.ArrayLike, model: Model = Model.CORRECTED) -> Floats:
        """base_T_0 (identity), base_T_1 ... base_T_N, base_T_flange [..., joints + 2, 7]; NaN where q is refused."""
        rows = _rows(q, self.joint_count, "q")
        frames = np.empty(rows.shape[:-1] + (self.joint_count + 2, 7))
        status = np.empty(rows.shape[:-1], np.int32)
        _lib.mdhcal_link_frames_rows(self._storage, Model(model), status.size, _at(rows), _at(frames), _at(status))
        return frames

    def tick_options(self, period_s: float) -> TickOptions:
        """The blob's tolerances, and step limits for a loop of this period, 0 < period_s <= 1000 [s]."""
        c = _library.TickOptions()
        status = Status(_lib.mdhcal_default_tick_options(self._storage, period_s, ctypes.addressof(c)))
        if status != Status.OK:
            raise Refused(f"options for a period of {period_s} s", status)
        return TickOptions(c.goal.position_tolerance_m, c.goal.rotation_tolerance_rad, c.goal.position_weight,
                           c.goal.rotation_weight, np.array(c.max_step), np.array(c.posture_q), c.posture_gain,
                           c.max_iterations, Task(c.goal.task))

    def inverse(self, base_T_flange: npt.ArrayLike, seed: npt.ArrayLike, options: Optional[TickOptions] = None,
                model: Model = Model.CORRECTED) -> Inverse:
        """One tick a row, each from a seed [..., joints] of its own (or one for all), without a step limit unless
        `options` say so. `status` as mdhcal_pose_to_joints: OK where the pose [..., 7] is met."""
        return Compensator(self, model).inverse(base_T_flange, seed, options)

    def solutions(self, base_T_flange: npt.ArrayLike, posture: npt.ArrayLike, *, restarts: int = 0,
                  options: Optional[TickOptions] = None) -> Solutions:
        """Every solution of poses [..., 7] on the corrected model within the joint limits, nearest to the posture
        [..., joints] first. restarts: 0 ... 400, for an arm without a closed form. OK, OUT_OF_REACH or BAD_INPUT."""
        pose = _rows(base_T_flange, 7, "base_T_flange")
        before = pose.shape[:-1]
        near = _spread(posture, before, self.joint_count, "posture").copy()
        count, status = np.empty(before, np.int32), np.empty(before, np.int32)
        q, distance = np.empty(before + (MAX_SOLUTIONS, self.joint_count)), np.empty(before + (MAX_SOLUTIONS,))
        goal = (options or self.tick_options(_NO_STEP_LIMIT_S))._c().goal
        _lib.mdhcal_find_solutions_rows(self._storage, ctypes.addressof(goal), restarts, status.size, _at(pose), _at(near),
                                        _at(count), _at(q), _at(distance), _at(status))
        return Solutions(count, q, distance, status)


class Compensator:
    """One loop's compensator, at rest on a model: mdhcal/compensator.hpp. A row of an array is a tick."""

    def __init__(self, arm: CalibratedArm, model: Model = Model.CORRECTED) -> None:
        self.arm = arm
        self._arms = [arm]  # all of them live as long as this: a ramp may refer to what it comes from
        self._storage = _storage(1)
        _check("compensator", _lib.mdhcal_start_at_rest(self._storage, ctypes.sizeof(self._storage), arm._storage,
                                                        Model(model)))

    def start_ramp(self, arm: CalibratedArm, ticks: int, model: Model = Model.CORRECTED) -> None:
        """Goes to a model of the same robot in so many ticks. Raises Refused for another robot."""
        _check("ramp", _lib.mdhcal_start_ramp(self._storage, arm._storage, Model(model), ticks))
        self._arms.append(arm)
        self.arm = arm

    def start_payload_ramp(self, payload_kg: float, ticks: int) -> None:
        """Goes to another payload in so many ticks. Raises Refused where the calibration does not know what it does."""
        _check("payload", _lib.mdhcal_start_payload_ramp(self._storage, payload_kg, ticks))

    def start_frame_ramp(self, base_T_user: npt.ArrayLike, flange_T_tool: npt.ArrayLike, ticks: int) -> None:
        """Goes to other frames [7], [7] in so many ticks."""
        user, tool = _rows(base_T_user, 7, "base_T_user"), _rows(flange_T_tool, 7, "flange_T_tool")
        if user.ndim != 1 or tool.ndim != 1:
            raise ValueError(f"Frames of the shapes {user.shape} and {tool.shape}; expected one pose [7] each.")
        _check("ramp", _lib.mdhcal_start_frame_ramp(self._storage, _at(user), _at(tool), ticks))

    @property
    def ramp_ticks_left(self) -> int:
        """Ticks until it is at rest."""
        return int(_lib.mdhcal_ramp_ticks_left(self._storage))

    def inverse(self, user_T_tool: npt.ArrayLike, seed: npt.ArrayLike, options: Optional[TickOptions] = None) -> Inverse:
        """As CalibratedArm.inverse(), on the model and the frames of this tick; the ramp stays where it is."""
        pose = _rows(user_T_tool, 7, "user_T_tool")
        before, joints = pose.shape[:-1], self.arm.joint_count
        q = _spread(seed, before, joints, "seed").copy()
        status, report = np.empty(before, np.int32), np.empty(before, _REPORT)
        c = (options or self.arm.tick_options(_NO_STEP_LIMIT_S))._c()
        _lib.mdhcal_inverse_rows(self._storage, joints, ctypes.addressof(c), status.size, _at(pose), _at(q), _at(report),
                                 _at(status))
        return Inverse(q, status, report)

    def poses_to_joints(self, user_T_tool: npt.ArrayLike, q: npt.ArrayLike, options: TickOptions) -> Inverse:
        """A loop over poses [ticks, 7] from the joints q [joints]: result [ticks, joints]. Each tick advances the ramp. A
        tick that is refused leaves the joints where they are, and its status says why."""
        return self._loop("poses_to_joints", user_T_tool, 7, q, options)

    def joints_to_joints(self, nominal_q: npt.ArrayLike, q: npt.ArrayLike, options: TickOptions) -> Inverse:
        """The same over the controller's own joints [ticks, joints], made true."""
        return self._loop("joints_to_joints", nominal_q, self.arm.joint_count, q, options)

    def poses_to_poses(self, user_T_tool: npt.ArrayLike, q: npt.ArrayLike, options: TickOptions) -> Inverse:
        """The same with `command` [ticks, 7]: the poses to command to a controller that keeps its nominal model."""
        return self._loop("poses_to_poses", user_T_tool, 7, q, options)

    def _loop(self, form: str, inputs: npt.ArrayLike, width: int, q: npt.ArrayLike, options: TickOptions) -> Inverse:
        rows, joints = _rows(inputs, width, "input"), self.arm.joint_count
        last = np.array(q, dtype=np.float64)
        if rows.ndim != 2 or last.shape != (joints,):
            raise ValueError(f"Input of the shape {rows.shape} and joints of the shape {last.shape}; expected "
                             f"(ticks, {width}) and ({joints},).")
        path, status = np.empty((len(rows), joints)), np.empty(len(rows), np.int32)
        report = np.empty(len(rows), _REPORT)
        command = np.empty((len(rows), 7)) if form == "poses_to_poses" else None
        extra = [] if command is None else [_at(command)]
        c = options._c()
        getattr(_lib, f"mdhcal_loop_{form}")(self._storage, joints, ctypes.addressof(c), len(rows), _at(rows), _at(last),
                                             _at(path), *extra, _at(report), _at(status))
        return Inverse(path, status, report, command)


_NO_STEP_LIMIT_S = 1000.0  # the longest period: the default velocity times it is beyond every reading


def _check(what: str, status: int) -> None:
    if status != Status.OK:
        raise Refused(what, Status(status))


def _storage(number: int) -> Any:
    """Zeroed storage of a struct that the library alone knows, aligned as a double."""
    size = _lib.mdhcal_bytes_of(number)
    return (ctypes.c_double * ((size + 7) // 8))()


def _at(array: npt.NDArray[Any]) -> int:
    return array.ctypes.data


def _rows(values: npt.ArrayLike, width: int, name: str) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if np.ndim(values) == 0 or array.shape[-1] != width:
        raise ValueError(f"{name} has the shape {np.shape(values)}; expected (..., {width}).")
    return array


def _spread(values: npt.ArrayLike, before: Tuple[int, ...], width: int, name: str) -> Floats:
    """One row for all, or a row each."""
    return np.ascontiguousarray(np.broadcast_to(_rows(values, width, name), before + (width,)))


def _eight(values: npt.ArrayLike) -> Any:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (MAX_JOINTS,):
        raise ValueError(f"An option has the shape {array.shape}; expected ({MAX_JOINTS},).")
    return (ctypes.c_double * MAX_JOINTS)(*array)
