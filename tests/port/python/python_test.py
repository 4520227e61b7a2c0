#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Python package: python_test.py PACKAGE_FOLDER C_LOOP [unittest...]. Holds it against the same loops in C, bit for bit and
in time, against differences and closed loops of its own, and against the headers that it repeats."""
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, sys.argv[1])
import numpy as np

import mdhcal
from mdhcal import _library

GOLDEN = ROOT / "tests/blob/golden"
BLOB = max(GOLDEN.glob("written-arithmetic-*.blob"), key=lambda path: int(path.name.split("-")[2]))
CORRECTED = GOLDEN / "six-joints-2.0.blob"  # of which nominal and corrected geometry differ


def readings(arm, rows, seed, spread=1.0):
    """Readings within the limits, with a seed of their own."""
    low = np.array([-2.5 if joint.min is None else max(joint.min, -2.5) for joint in arm.joints])
    high = np.array([2.5 if joint.max is None else min(joint.max, 2.5) for joint in arm.joints])
    middle, half = (low + high) / 2, spread * (high - low) / 2
    return middle + half * np.random.default_rng(seed).uniform(-1, 1, (rows, arm.joint_count))


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.arm = mdhcal.load(BLOB)

    def test_repeats_the_headers(self):
        header = (ROOT / "lib/include/mdhcal.h").read_text()
        statuses = dict(re.findall(r"MDHCAL_([A-Z_]+) = (\d+)", re.search(r"enum \{\s*MDHCAL_OK.*?\};", header, re.S).group()))
        self.assertEqual({name: int(value) for name, value in statuses.items()},
                         {status.name: status.value for status in mdhcal.Status})
        for name in ("MAX_JOINTS", "MAX_SOLUTIONS", "MAX_TARGETS"):
            self.assertEqual(int(re.search(rf"MDHCAL_{name} (\d+)", header).group(1)), getattr(mdhcal, name))
        self.assertEqual(int(re.search(r"MDHCAL_ABI_VERSION (\d+)u", header).group(1)), _library.ABI_VERSION)
        for struct, c in [(_library.TickReport, "tick_report"), (_library.GoalOptions, "goal_options")]:
            text = (ROOT / "lib/include/mdhcal/c_functions.h").read_text()
            body = re.search(rf"MDHCAL_C_NAME\({c}\) \{{(.*?)\}}", text, re.S).group(1)
            self.assertEqual(re.findall(r"(\w+);", body), [field[0] for field in struct._fields_])
        body = re.search(r"struct mdhcal_description \{(.*?)\}", header, re.S).group(1)
        self.assertEqual(re.findall(r"(\w+)(?:\[\w+\])?[,;]", body), [field[0] for field in _library.Description._fields_])

    def test_what_the_blob_says(self):
        self.assertEqual(self.arm.status, mdhcal.Status.OK)
        self.assertEqual(self.arm.joint_count, len(self.arm.joints))
        data = BLOB.read_bytes()
        self.assertIn(self.arm.name.encode(), data)
        self.assertTrue(self.arm.name)
        self.assertEqual(mdhcal.load(data, serial=self.arm.serial or None).name, self.arm.name)
        self.assertIn(self.arm.provenance.tool_version.encode(), data)
        self.assertRegex(self.arm.provenance.date, r"^\d{4}-\d\d-\d\d$")
        self.assertIsNone(self.arm.provenance.mean_after_m)  # packed from a robot file, not measured
        self.assertEqual(mdhcal.load(CORRECTED).status, mdhcal.Status.SELF_TEST_TOLERANCE)

    def test_refusals_say_why(self):
        data = bytearray(BLOB.read_bytes())
        for blob, demands, status in [
                (bytes(data[:100]), {}, mdhcal.Status.BLOB_SIZE),
                (bytes([data[0] ^ 1]) + bytes(data[1:]), {}, mdhcal.Status.BLOB_MAGIC),
                (bytes(data), {"serial": "another robot"}, mdhcal.Status.BLOB_SERIAL),
                (bytes(data), {"verify": lambda message, signature: True}, mdhcal.Status.BLOB_UNSIGNED),
                (bytes(data), {"minimum_counter": 4000000000}, mdhcal.Status.BLOB_COUNTER)]:
            with self.assertRaises(mdhcal.Refused) as refused:
                mdhcal.load(blob, **demands)
            self.assertEqual(refused.exception.status, status)
            self.assertIn(status.text, str(refused.exception))
        with self.assertRaises(OSError):
            mdhcal.load("there is no such file")
        with self.assertRaisesRegex(ValueError, r"q has the shape \(3,\); expected \(\.\.\., 6\)"):
            self.arm.forward([0.0, 0.0, 0.0])
        with self.assertRaises(mdhcal.Refused):
            self.arm.tick_options(-1.0)

    def test_shapes_and_refused_rows(self):
        q = readings(self.arm, 24, 1).reshape(2, 3, 4, 6)
        self.assertEqual(self.arm.forward(q).pose.shape, (2, 3, 4, 7))
        self.assertEqual(self.arm.jacobian(q).jacobian.shape, (2, 3, 4, 6, 6))
        self.assertEqual(self.arm.link_frames(q[0, 0, 0]).shape, (8, 7))
        self.assertEqual(self.arm.forward(q[0, 0, 0]).status, 0)
        self.assertEqual(self.arm.forward(q[:0]).pose.shape, (0, 3, 4, 7))
        strided = np.asfortranarray(q[0, 0])
        np.testing.assert_array_equal(self.arm.forward(strided).pose, self.arm.forward(q[0, 0]).pose)
        bad = q[0, 0].copy()
        bad[1, 2] = np.nan
        result = self.arm.jacobian(bad)
        np.testing.assert_array_equal(result.status, [0, mdhcal.Status.BAD_INPUT, 0, 0])
        np.testing.assert_array_equal(np.isnan(result.pose).all(-1), [False, True, False, False])
        np.testing.assert_array_equal(np.isnan(result.jacobian).all((-1, -2)), [False, True, False, False])
        poses = self.arm.forward(q[0, 0]).pose
        poses[2, 0] = np.inf
        inverse = self.arm.inverse(poses, q[0, 0])
        np.testing.assert_array_equal(mdhcal.usable(inverse.status), [True, True, False, True])
        self.assertTrue(np.isnan(inverse.q[2]).all())
        self.assertTrue(np.isnan(mdhcal.invert(poses)[2]).all())

    def test_jacobian_is_the_derivative(self):
        q, h = readings(self.arm, 50, 2), 1e-6
        pose, jacobian, _ = self.arm.jacobian(q)
        for j in range(self.arm.joint_count):
            step = h * np.eye(self.arm.joint_count)[j]
            ahead, behind = self.arm.forward(q + step).pose, self.arm.forward(q - step).pose
            np.testing.assert_allclose(jacobian[:, :3, j], (ahead - behind)[:, 4:] / (2 * h), atol=1e-8)
            turn = mdhcal.multiply(ahead, mdhcal.invert(behind))[:, 1:4] / h
            np.testing.assert_allclose(jacobian[:, 3:, j], turn, atol=1e-8)

    def test_poses_multiply_as_matrices(self):
        poses = self.arm.forward(readings(self.arm, 40, 3)).pose
        a, b = poses[:20], poses[20:]
        np.testing.assert_allclose(mdhcal.matrix(mdhcal.multiply(a, b)), mdhcal.matrix(a) @ mdhcal.matrix(b), atol=1e-14)
        np.testing.assert_allclose(mdhcal.matrix(mdhcal.invert(a)), np.linalg.inv(mdhcal.matrix(a)), atol=1e-14)
        np.testing.assert_array_equal(mdhcal.multiply(a[0], b), mdhcal.multiply(np.tile(a[0], (20, 1)), b))
        frames = self.arm.link_frames(readings(self.arm, 20, 3))
        np.testing.assert_array_equal(frames[:, 0], np.tile([1, 0, 0, 0, 0, 0, 0], (20, 1)))
        np.testing.assert_allclose(frames[:, -1], self.arm.forward(readings(self.arm, 20, 3)).pose, atol=1e-14)

    def test_every_solution_meets_its_pose(self):
        q = readings(self.arm, 40, 4)
        poses = self.arm.forward(q).pose
        found = self.arm.solutions(poses, q)
        self.assertTrue((found.count >= 1).all())
        for row in range(len(q)):
            there = found.q[row, :found.count[row]]
            pose = self.arm.forward(there).pose
            np.testing.assert_allclose(pose[:, 4:], np.tile(poses[row, 4:], (len(there), 1)), atol=1e-9)
            self.assertTrue(np.isnan(found.q[row, found.count[row]:]).all())
            np.testing.assert_allclose(there[0], q[row], atol=1e-6)  # nearest to the posture first

    def test_loop_and_ramp(self):
        arm = mdhcal.load(CORRECTED)
        nominal = readings(arm, 1, 5, 0.5) + 0.05 * np.sin(np.arange(400)[:, None] * 0.005 + np.arange(6))
        loop = mdhcal.Compensator(arm, mdhcal.Model.NOMINAL)
        options = arm.tick_options(0.001)
        still = loop.joints_to_joints(nominal[:100], nominal[0], options)
        np.testing.assert_allclose(still.q, nominal[:100], atol=1e-9)
        loop.start_ramp(arm, 200)
        moved = loop.joints_to_joints(nominal[100:], still.q[-1], options)
        self.assertEqual(loop.ramp_ticks_left, 0)
        self.assertTrue(mdhcal.usable(moved.status).all())
        wanted = arm.forward(nominal[350:], mdhcal.Model.NOMINAL).pose
        np.testing.assert_allclose(arm.forward(moved.q[250:]).pose[:, 4:], wanted[:, 4:], atol=1e-9)
        # The pose to command: its nominal joints are the corrected ones.
        command = loop.poses_to_poses(wanted, moved.q[250], options)
        back = arm.forward(command.q, mdhcal.Model.NOMINAL).pose
        np.testing.assert_allclose(command.command[:, 4:], back[:, 4:], atol=1e-9)
        by_pose = loop.poses_to_joints(wanted, moved.q[250], options)
        np.testing.assert_allclose(by_pose.q, moved.q[250:], atol=1e-7)
        self.assertGreater(np.abs(moved.q[250:] - nominal[350:]).max(), 1e-5)  # the two models differ
        # A tool: the flange goes where the tool's inverse puts it.
        tool = np.array([1.0, 0, 0, 0, 0, 0, 0.1])
        loop.start_frame_ramp([1, 0, 0, 0, 0, 0, 0], tool, 0)
        with_tool = loop.inverse(mdhcal.multiply(wanted, tool), by_pose.q)
        np.testing.assert_allclose(arm.forward(with_tool.q).pose[:, 4:], wanted[:, 4:], atol=1e-9)

    def test_threads_share_an_arm(self):
        q = readings(self.arm, 2000, 6)
        wanted, results = self.arm.forward(q).pose, [None] * 4

        def work(index):
            results[index] = self.arm.forward(q).pose

        threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            np.testing.assert_array_equal(result, wanted)

    def test_same_bits_as_the_c_loop_in_the_same_time(self):
        rows, joints = 100000, self.arm.joint_count
        q = readings(self.arm, rows, 7)
        seeds = q + 0.01
        options = self.arm.tick_options(0.001)
        poses = self.arm.forward(q).pose

        def servo():
            return mdhcal.Compensator(self.arm).joints_to_joints(q, q[0], options).q

        work = {"forward": lambda: self.arm.forward(q).pose, "jacobian": lambda: self.arm.jacobian(q).jacobian.swapaxes(1, 2),
                "inverse": lambda: self.arm.inverse(poses, seeds).q, "loop": servo}
        with tempfile.TemporaryDirectory() as folder:
            given, made = pathlib.Path(folder, "q"), pathlib.Path(folder, "out")
            given.write_bytes(q.tobytes())
            command = [C_LOOP, BLOB, str(rows), str(joints), given, made]
            # Other programs on the machine slow one or the other: the least of both, taken in turn until they agree.
            in_c, here = np.full(4, np.inf), np.full(4, np.inf)
            for _ in range(4):
                done = subprocess.run(command, capture_output=True, text=True, check=True)
                in_c = np.minimum(in_c, [float(line) for line in done.stdout.split()])
                for index, compute in enumerate(work.values()):
                    for _ in range(3):
                        begin = time.process_time()
                        compute()
                        here[index] = min(here[index], time.process_time() - begin)
                if (here <= 1.5 * in_c).all():
                    break
            values = np.frombuffer(made.read_bytes())
        at = 0
        for name, compute in work.items():
            result = np.ascontiguousarray(compute())
            same = values[at:at + result.size].reshape(result.shape)
            at += result.size
            self.assertEqual(result.tobytes(), same.tobytes(), name)
        for name, c, python in zip(work, in_c, here):
            print(f"{name}: {rows} rows in {1e3 * c:.1f} ms in C, {1e3 * python:.1f} ms in Python: {python / c:.2f}")
            self.assertLessEqual(python, 1.5 * c, name)


if __name__ == "__main__":
    C_LOOP = sys.argv[2]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
