# SPDX-License-Identifier: MIT
"""The shared library and the structs of mdhcal.h, field for field. Private: `import mdhcal` is the interface."""
import ctypes
import os
import pathlib
from ctypes import POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint8, c_uint32, c_void_p

ABI_VERSION = 3  # MDHCAL_ABI_VERSION of the header that this file repeats
MAX_JOINTS, MAX_SOLUTIONS, MAX_TARGETS = 8, 16, 8
BLOB_BYTES = 8160

VERIFY = ctypes.CFUNCTYPE(c_int32, POINTER(c_uint8), c_size_t, POINTER(c_uint8), c_void_p)


class Demands(Structure):
    _fields_ = [("serial", c_char_p), ("verify", VERIFY), ("verify_context", c_void_p), ("minimum_counter", c_uint32)]


class Target(Structure):
    _fields_ = [("name", c_char * 16), ("flange_p_m", c_double * 3)]


class Provenance(Structure):
    _fields_ = [("tool_version", c_char * 32), ("date", c_char * 16), ("method", c_char * 16), ("lambda_rule", c_char * 32),
                ("measurements_sha256", c_uint8 * 32), ("pose_count", c_uint32), ("held_out_count", c_uint32),
                ("has_measurements", c_int32), ("has_lambda", c_int32), ("has_held_out", c_int32), ("lambda_", c_double),
                ("mean_before_m", c_double), ("max_before_m", c_double), ("mean_after_m", c_double),
                ("max_after_m", c_double), ("has_region", c_int32), ("region_min_m", c_double * 3),
                ("region_max_m", c_double * 3), ("lean_min_m", c_double), ("lean_max_m", c_double)]


class Tolerances(Structure):
    _fields_ = [("position_m", c_double), ("rotation_rad", c_double), ("float_position_m", c_float),
                ("float_rotation_rad", c_float)]


class Description(Structure):
    _fields_ = [("name", c_char * 64), ("serial", c_char * 32), ("has_base", c_int32), ("target_count", c_int32),
                ("tracker_T_base_quaternion", c_double * 4), ("tracker_T_base_position_m", c_double * 3),
                ("target", Target * MAX_TARGETS), ("family", c_int32), ("security_counter", c_uint32),
                ("tolerances", Tolerances), ("max_velocity", c_double * MAX_JOINTS), ("provenance", Provenance)]


class Joint(Structure):
    _fields_ = [("slides", c_int32), ("has_min", c_int32), ("has_max", c_int32), ("min", c_double), ("max", c_double)]


class GoalOptions(Structure):
    _fields_ = [("position_tolerance_m", c_double), ("rotation_tolerance_rad", c_double), ("position_weight", c_double),
                ("rotation_weight", c_double), ("task", c_int32)]


class TickOptions(Structure):
    _fields_ = [("goal", GoalOptions), ("max_step", c_double * MAX_JOINTS), ("posture_q", c_double * MAX_JOINTS),
                ("posture_gain", c_double), ("max_iterations", c_int32)]


class TickReport(Structure):
    _fields_ = [("position_error_m", c_double), ("rotation_error_rad", c_double), ("smallest_singular_value", c_double),
                ("iterations", c_int32), ("step_mask", c_uint32), ("limit_mask", c_uint32), ("unseen_mask", c_uint32)]


def find() -> pathlib.Path:
    """The shared library: the file that MDHCAL_LIBRARY names, or the one beside this file."""
    named = os.environ.get("MDHCAL_LIBRARY")
    if named:
        return pathlib.Path(named)
    here = pathlib.Path(__file__).resolve().parent
    for name in ("libmdhcal_arrays.so", "libmdhcal_arrays.dylib", "mdhcal_arrays.dll"):
        if (here / name).exists():
            return here / name
    raise ImportError(f"No shared library of mdhcal in {here}; expected libmdhcal_arrays.so. Build the CMake target "
                      "mdhcal_arrays and take the package from build/host/python or from `cmake --install build/host "
                      "--component python`, or name the library by MDHCAL_LIBRARY.")


def load() -> ctypes.CDLL:
    path = find()
    library = ctypes.CDLL(str(path))
    # A pointer is void here: what an array or a struct holds was checked before, by __init__.py.
    address, count = c_void_p, c_size_t
    signatures = {
        "mdhcal_abi_version": (c_uint32, []),
        "mdhcal_bytes_of": (c_size_t, [c_int32]),
        "mdhcal_status_text": (c_char_p, [c_int32]),
        "mdhcal_usable": (c_int32, [c_int32]),
        "mdhcal_check_environment": (c_int32, []),
        "mdhcal_load": (c_int32, [address, count, c_uint32, c_char_p, count, address]),
        "mdhcal_joint_count": (c_int32, [address]),
        "mdhcal_describe_joint": (c_int32, [address, c_int32, address]),
        "mdhcal_describe": (c_int32, [address, address]),
        "mdhcal_default_tick_options": (c_int32, [address, c_double, address]),
        "mdhcal_start_at_rest": (c_int32, [address, count, address, c_int32]),
        "mdhcal_start_ramp": (c_int32, [address, address, c_int32, c_uint32]),
        "mdhcal_start_frame_ramp": (c_int32, [address, address, address, c_uint32]),
        "mdhcal_start_payload_ramp": (c_int32, [address, c_double, c_uint32]),
        "mdhcal_refers_to": (c_int32, [address, address]),
        "mdhcal_ramp_ticks_left": (c_uint32, [address]),
        "mdhcal_forward_rows": (None, [address, c_int32, count] + [address] * 4),
        "mdhcal_link_frames_rows": (None, [address, c_int32, count] + [address] * 3),
        "mdhcal_multiply_rows": (None, [count] + [address] * 4),
        "mdhcal_invert_rows": (None, [count] + [address] * 3),
        "mdhcal_inverse_rows": (None, [address, c_int32, address, count] + [address] * 4),
        "mdhcal_find_solutions_rows": (None, [address, address, c_int32, count] + [address] * 6),
        "mdhcal_loop_poses_to_joints": (None, [address, c_int32, address, count] + [address] * 5),
        "mdhcal_loop_joints_to_joints": (None, [address, c_int32, address, count] + [address] * 5),
        "mdhcal_loop_poses_to_poses": (None, [address, c_int32, address, count] + [address] * 6),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    if library.mdhcal_abi_version() != ABI_VERSION:
        raise ImportError(f"{path} has version {library.mdhcal_abi_version()} of the C interface; expected {ABI_VERSION}.")
    # The order of the list in arrays.h; the first two are opaque and have no struct here.
    for number, struct in enumerate((Demands, Description, Joint, TickOptions, TickReport, GoalOptions), 2):
        if library.mdhcal_bytes_of(number) != ctypes.sizeof(struct):
            raise ImportError(f"{path}: a struct {struct.__name__} of {library.mdhcal_bytes_of(number)} bytes; expected "
                              f"{ctypes.sizeof(struct)}.")
    return library
