#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Drives the example firmware in QEMU as a user would: firmware_test.py HOST_PROGRAM BUILD_OF_THE_CORTEX_M7 [unittest...]

The flash is a file behind the board's RAM, so it outlives the emulated board however that ends.
"""
import csv
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[3]
FLASH_BYTES = 16 << 20
SLOT = 8192
MAX_STEP = 0.00314
DOUBLE_VECTORS = 2368  # of the blob: the first self-test vector's first reading

# Three parallel axes, in millimetres and degrees (Li 2022, Table 1).
NOMINAL = [(0.0, 0.0, 99.927), (90.0, 0.0, 106.95), (0.0, 428.052, 0.0), (0.0, 398.551, 0.0), (-90.0, 0.0, 93.16),
           (-90.0, 0.0, 81.91)]


def robot_file(serial, errors):
    """A corrected robot: the nominal table, and `errors` as {(link, key): deviation}."""
    lines = ['name = "cobot-6r"', f'serial = "{serial}"']
    for i, (alpha, a, d) in enumerate(NOMINAL, start=1):
        value = {"alpha": alpha, "a": a, "d": d, "theta": 0.0, "beta": 0.0}
        nominal = ", ".join(f"{key} = {number!r}" for key, number in value.items())
        lines.append("[[link]]")
        for key in value:
            lines.append(f"{key} = {value[key] + errors.get((i, key), 0.0)!r}")
        lines.append(f"nominal = {{{nominal}}}")
    return "\n".join(lines) + "\n"


ROBOTS = {
    "nominal": ("SN-0001", {}),
    "first": ("SN-0001", {(2, "alpha"): 0.05, (3, "a"): 0.9, (5, "d"): 0.7, (4, "theta"): 0.1, (2, "beta"): 0.04}),
    "second": ("SN-0001", {(2, "alpha"): 0.08, (3, "a"): 1.4, (5, "d"): 0.2, (4, "theta"): 0.2, (3, "beta"): 0.03}),
    "far": ("SN-0001", {(2, "theta"): 2.5, (3, "theta"): -2.5, (5, "theta"): 2.5}),
    "other": ("SN-0002", {}),
}


class Board:
    """The firmware on one flash, until it ends or is cut off."""

    def __init__(self, flash, *arguments):
        options = ",".join("arg=" + argument for argument in ("firmware", *arguments))
        self.process = subprocess.Popen(
            ["qemu-system-arm", "-M", "mps2-an500", "-icount", "shift=3", "-display", "none", "-monitor", "none",
             "-object", f"memory-backend-file,id=flash,size=16M,mem-path={flash},share=on", "-machine",
             "memory-backend=flash", "-serial", "stdio", "-semihosting-config", f"enable=on,target=native,{options}",
             "-kernel", str(BUILD / "bin/firmware")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.lines = []
        self.watchdog = threading.Timer(30, self.process.kill)
        self.watchdog.start()

    def send(self, data):
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def send_blob(self, blob):
        self.send(b"MDHU" + struct.pack("<I", len(blob)) + blob)

    def wait_for(self, text):
        """Reads the trace up to a line with `text`."""
        for raw in self.process.stdout:
            self.lines.append(raw.decode().rstrip("\n"))
            if text in self.lines[-1]:
                return self.lines[-1]
        raise AssertionError(f"no line with {text!r}; {self.tail()}")

    def quit(self):
        self.send(b"MDHQ")
        return self.finish()

    def finish(self):
        self.lines += [raw.decode().rstrip("\n") for raw in self.process.stdout]
        status = self.process.wait()
        self.close()
        return status

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        return self.finish()

    def stop(self):
        """After a failed test."""
        self.process.kill()
        self.process.wait()
        self.close()

    def close(self):
        self.watchdog.cancel()
        self.process.stdin.close()
        self.process.stdout.close()

    def has(self, text):
        return any(text in line for line in self.lines)

    def tail(self):
        return "\n".join(["trace:", *(line[:100] for line in self.lines[-12:])])

    def motion(self):
        """The traced ticks: mode, path joints, commanded joints, largest step, limited, not met."""
        number = lambda digits: struct.unpack(">d", bytes.fromhex(digits))[0]
        found = []
        for line in self.lines:
            match = re.match(r"(tick|end) (\d+) (\w+) path(.*) command(.*) largest (\w+) limited (\d+) not-met (\d+)", line)
            if match:
                found.append({"tick": int(match[2]), "mode": match[3], "path": [*map(number, match[4].split())],
                              "command": [*map(number, match[5].split())], "largest": number(match[6]),
                              "limited": int(match[7]), "not_met": int(match[8])})
        return found


class Firmware(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.here = pathlib.Path(cls.folder.name)
        cls.blob, cls.slot = {}, {}
        for name, (serial, errors) in ROBOTS.items():
            toml, blob, image = (cls.here / f"{name}{suffix}" for suffix in (".toml", ".blob", ".bin"))
            toml.write_text(robot_file(serial, errors))
            cls.mdhcal("pack", toml, "-o", blob, "--date", "2026-01-01")
            cls.mdhcal("export", blob, "--slot", "--sequence", "7", "--format", "bin", "--address", "0x60000000", "-o", image)
            cls.blob[name] = blob.read_bytes()
            cls.slot[name] = image.read_bytes()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def mdhcal(cls, *arguments):
        return subprocess.run([MDHCAL, *map(str, arguments)], check=True, capture_output=True, text=True).stdout

    def flash(self, name=None):
        """A flash with a factory image in slot 0, or an erased one."""
        path = self.here / "flash.bin"
        content = bytearray(b"\xff" * (2 * SLOT))
        if name:
            content[: len(self.slot[name])] = self.slot[name]
        with open(path, "wb") as file:
            file.write(content)
            file.truncate(FLASH_BYTES)
        return path

    def start(self, flash, *arguments):
        board = Board(flash, *arguments)
        self.addCleanup(board.stop)
        return board

    def poses(self, name, rows):
        """Flange poses of joint vectors [rad] by the host's program, in millimetres."""
        joints = self.here / "joints.csv"
        with open(joints, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow([f"q{i}_rad" for i in range(1, 7)])
            writer.writerows([[repr(q) for q in row] for row in rows])
        output = self.mdhcal("forward", self.here / f"{name}.blob", joints)
        return [[float(row[key]) for key in ("x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz")]
                for row in csv.DictReader(output.splitlines())]

    def expect_gentle(self, board):
        motion = board.motion()
        self.assertTrue(motion)
        self.assertLessEqual(motion[-1]["largest"], MAX_STEP)
        self.assertEqual(motion[-1]["limited"], 0)
        self.assertEqual(motion[-1]["not_met"], 0)
        return motion

    def expect_still(self, board):
        self.assertFalse(board.has("swap: done"))
        self.assertTrue(board.motion())
        for row in board.motion():
            self.assertEqual(row["command"], [0.0] * 6)

    def expect_true_to(self, name, motion):
        """What was commanded brings the corrected arm where the nominal one was meant to be."""
        self.assertTrue(motion)
        meant = self.poses("nominal", [row["path"] for row in motion])
        reached = self.poses(name, [row["command"] for row in motion])
        for a, b in zip(meant, reached):
            self.assertLess(max(abs(x - y) for x, y in zip(a[:3], b[:3])), 1e-6)
            self.assertLess(max(abs(x - y) for x, y in zip(a[3:], b[3:])), 1e-9)

    def test_boots_from_an_exported_image_and_follows_the_path(self):
        board = self.start(self.flash("first"), "--serial", "SN-0001", "--ticks", "1500")
        self.assertEqual(board.finish(), 0)
        self.assertTrue(board.has("self-test: ok"))
        self.assertTrue(board.has("boot: slot 0, sequence 7, robot cobot-6r, serial SN-0001"))
        self.assertTrue(board.has("swap: done"))
        motion = self.expect_gentle(board)
        corrected = [row for row in motion if row["mode"] == "corrected"]
        self.expect_true_to("first", corrected)
        self.assertNotEqual(corrected[-1]["path"], corrected[-1]["command"])
        print(next(line for line in board.lines if line.startswith("worst tick")))

    def test_takes_a_new_blob_while_running_and_keeps_it(self):
        flash = self.flash("first")
        board = self.start(flash)
        board.wait_for("swap: done")
        board.send_blob(self.blob["second"])
        board.wait_for("update: committed to slot 1, sequence 8")
        board.wait_for("swap: done")
        swapped = len(board.motion())
        for _ in range(5):
            board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        motion = self.expect_gentle(board)
        self.expect_true_to("second", motion[swapped + 1:])
        again = self.start(flash, "--ticks", "700")
        self.assertEqual(again.finish(), 0)
        self.assertTrue(again.has("boot: slot 1, sequence 8"))
        self.expect_gentle(again)

    def test_power_cut_at_flash_changes_of_an_update(self):
        outcomes = set()
        # One erase, 255 granules of the blob, and the header last.
        for change in (1, 2, 3, 128, 255, 256, 257):
            flash = self.flash("first")
            board = self.start(flash, "--cut-after", str(change))
            board.wait_for("swap: done")
            board.send_blob(self.blob["second"])
            self.assertEqual(board.finish(), 3, board.tail())
            self.assertTrue(board.has("flash: power cut"))
            again = self.start(flash)
            line = again.wait_for(", sequence ")
            outcomes.add((change == 257, line.split(",")[0]))
            again.wait_for("swap: done")
            again.send_blob(self.blob["second"])
            again.wait_for("update: committed")
            again.wait_for("swap: done")
            self.assertEqual(again.quit(), 0)
            self.expect_gentle(again)
        self.assertEqual(outcomes, {(False, "boot: slot 0"), (True, "boot: slot 1")})

    def test_killed_in_the_middle_of_an_update(self):
        for granule in (0, 80, 254):
            flash = self.flash("first")
            board = self.start(flash)
            board.wait_for("swap: done")
            board.send_blob(self.blob["second"])
            board.wait_for(f"flash: program {SLOT + 32 * (granule + 1)}")
            board.kill()
            again = self.start(flash, "--ticks", "600")
            self.assertEqual(again.finish(), 0)
            self.assertTrue(again.has("boot: slot 0, sequence 7") or again.has("boot: slot 1, sequence 8"))
            self.expect_gentle(again)

    def test_an_update_that_stops_or_is_damaged_keeps_the_active_model(self):
        board = self.start(self.flash("first"), "--serial", "SN-0001")
        board.wait_for("swap: done")
        board.send(b"MDHU" + struct.pack("<I", 8160) + self.blob["second"][:2048])
        board.wait_for("update: abandoned after 2048 bytes")
        board.send(b"MDHU" + struct.pack("<I", 12))
        board.wait_for("update: refused, wrong size")
        damaged = bytearray(self.blob["second"])
        damaged[300] ^= 4
        board.send_blob(bytes(damaged))
        board.wait_for("update: refused, CRC-32 mismatch; the active model stays")
        board.send_blob(self.blob["other"])
        board.wait_for("update: refused, made for another robot; the active model stays")
        # The CRC-32 holds, but not what the self-test computes.
        wrong = bytearray(self.blob["second"])
        wrong[DOUBLE_VECTORS] ^= 1
        wrong[-4:] = struct.pack("<I", zlib.crc32(wrong[:-4]))
        board.send_blob(bytes(wrong))
        board.wait_for("self-test: self-test failed")
        board.wait_for("update: refused, self-test failed; the active model stays")
        before = len(board.motion())
        for _ in range(3):
            board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        self.assertFalse(board.has("flash:"))
        self.expect_true_to("first", self.expect_gentle(board)[before:])

    def test_an_update_that_the_flash_fails_keeps_the_active_model(self):
        flash = self.flash("first")
        board = self.start(flash, "--fail-after", "60")
        board.wait_for("swap: done")
        board.send_blob(self.blob["second"])
        board.wait_for("update: refused, flash program failed; the active model stays")
        before = len(board.motion())
        for _ in range(3):
            board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        self.expect_true_to("first", self.expect_gentle(board)[before:])
        again = self.start(flash, "--ticks", "700")
        self.assertEqual(again.finish(), 0)
        self.assertTrue(again.has("boot: slot 0, sequence 7"))
        self.expect_gentle(again)

    def test_a_swap_that_would_change_a_joint_too_much_is_refused(self):
        board = self.start(self.flash("first"))
        board.wait_for("swap: done")
        board.send_blob(self.blob["far"])
        board.wait_for("swap: refused, joint")
        before = len(board.motion())
        for _ in range(3):
            board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        self.expect_true_to("first", self.expect_gentle(board)[before:])

    def test_a_blob_too_far_from_nominal_at_boot_is_no_motion_that_nobody_allowed(self):
        board = self.start(self.flash("far"))
        board.wait_for("swap: refused, joint")
        self.assertIn("no motion", board.lines[-1])
        for _ in range(3):
            board.wait_for("tick ")
        self.expect_still(board)
        board.send_blob(self.blob["first"])
        board.wait_for("swap: done")
        board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        self.expect_true_to("first", [row for row in self.expect_gentle(board) if row["mode"] == "corrected"])
        allowed = self.start(self.flash("far"), "--allow-nominal", "--ticks", "500")
        self.assertEqual(allowed.finish(), 0)
        self.assertTrue(allowed.has("nominal joints, as the integrator allows"))
        self.assertTrue(all(row["mode"] == "nominal" for row in self.expect_gentle(allowed)))

    def test_no_blob_no_motion_until_one_comes(self):
        board = self.start(self.flash())
        board.wait_for("boot: no acceptable blob stored; no motion")
        for _ in range(3):
            board.wait_for("tick ")
        self.expect_still(board)
        board.send_blob(self.blob["first"])
        board.wait_for("swap: done")
        board.wait_for("tick ")
        self.assertEqual(board.quit(), 0)
        self.expect_true_to("first", [row for row in self.expect_gentle(board) if row["mode"] == "corrected"])

    def test_nominal_motion_only_where_the_integrator_allows_it(self):
        board = self.start(self.flash(), "--allow-nominal", "--ticks", "500")
        self.assertEqual(board.finish(), 0)
        for row in self.expect_gentle(board):
            self.assertEqual(row["mode"], "nominal")
            self.assertNotEqual(row["path"], [0.0] * 6)
            self.assertLess(max(abs(a - b) for a, b in zip(row["path"], row["command"])), 1e-12)

    def test_a_blob_for_another_serial_is_a_status_and_no_motion(self):
        board = self.start(self.flash("other"), "--serial", "SN-0001", "--ticks", "300")
        self.assertEqual(board.finish(), 0)
        self.assertTrue(board.has("boot: slot 0: made for another robot"))
        self.assertTrue(board.has("no motion"))
        self.expect_still(board)

    def test_a_flash_that_cannot_be_read_is_a_status_and_no_motion(self):
        board = self.start(self.flash("first"), "--flash-read-fails", "--ticks", "300")
        self.assertEqual(board.finish(), 0)
        self.assertTrue(board.has("boot: slot 0: flash read failed"))
        self.assertTrue(board.has("no motion"))
        self.expect_still(board)

    def test_an_image_for_the_m7_faults_by_name_on_the_m4f(self):
        # The firmware reads a flash that the other board lacks; the other image computes in double at once.
        for image, fault in (("firmware", "0x00008200 precise data bus error"), ("footprint", "0x00010000 undefined instruction")):
            done = subprocess.run([ROOT / "port/cortex_m/run.sh", "mps2-an386", BUILD / "bin" / image],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 70)
            self.assertIn(f"fault: CFSR {fault}", done.stdout + done.stderr)
            self.assertNotIn("tick", done.stdout)


if __name__ == "__main__":
    MDHCAL, BUILD = sys.argv[1], pathlib.Path(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
