#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The project as somebody's dependency: packaging_test.py BUILD [PRESET of a bare-metal target] [unittest...]"""
import json
import os
import pathlib
import platform
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
BOARD = ROOT / "port/cortex_m"
BLOB = max((ROOT / "tests/blob/golden").glob("written-arithmetic-*.blob"), key=lambda path: int(path.name.split("-")[2]))


def slot(blob, sequence):
    """A slot of 8 KiB with this blob, docs/blob.md."""
    head = struct.pack("<IIII", 0xECB2A0FD, sequence, int.from_bytes(blob[-4:], "little"), 0) + bytes(12)
    return (head + struct.pack("<I", zlib.crc32(head)) + blob).ljust(8192, b"\xff")


class Packaging(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.here = pathlib.Path(cls.folder.name)
        cls.prefix = cls.here / "moved" / "prefix"
        # Installed at one place and moved to another: nothing in it may name the first.
        first = cls.here / "first"
        cls.run_(["cmake", "--install", BUILD, "--prefix", first, "--component", "library"])
        cls.prefix.parent.mkdir()
        first.rename(cls.prefix)
        cls.toolchain, cls.board, cls.flags, cls.emulator, cls.prefix_ = [], [], [], [], ""
        if PRESET:
            toolchain = ROOT / f"cmake/toolchains/{PRESET}.cmake"
            text = toolchain.read_text()
            machine = re.search(r"MDHCAL_MACHINE (\S+)\)", text).group(1)
            cls.toolchain = [f"-DCMAKE_TOOLCHAIN_FILE={toolchain}"]
            cls.board = [f"-DCONSUMER_BOARD={BOARD}"]
            cls.flags = re.search(r'MDHCAL_CPU_FLAGS "(.*)"', text).group(1).split()
            cls.link = ["--specs=rdimon.specs", "-nostartfiles", "-Wl,--gc-sections", f"-L{BOARD}", f"-T{BOARD}/{machine}.ld"]
            cls.emulator, cls.prefix_ = [BOARD / "run.sh", machine], "arm-none-eabi-"
        else:
            cls.link = []
            if platform.machine() == "x86_64" and " fma " in pathlib.Path("/proc/cpuinfo").read_text():
                cls.flags = ["-mfma"]  # what would fuse, if it was let

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def run_(command, **options):
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(str(part) for part in command)}\n{done.stdout}{done.stderr}")
        return done.stdout

    def execute(self, program):
        self.run_([*self.emulator, program], timeout=60)

    def build(self, name, source, *options):
        build = self.here / name
        self.run_(["cmake", "-S", source, "-B", build, "-G", "Ninja", *self.toolchain, *options])
        self.run_(["cmake", "--build", build, "-j2"])
        return build / "consumer"

    def consumer(self, name, language, *options):
        return self.build(name, HERE / "consumer", f"-DCONSUMER_LANGUAGE={language}", *self.board, *options)

    def startup(self):
        """Objects of the board's start-up code, for links without CMake."""
        if not PRESET:
            return []
        item = self.here / "startup.o"
        self.run_([self.prefix_ + "gcc", *self.flags, "-O2", "-fno-tree-loop-distribute-patterns", "-c",
                   BOARD / "startup.c", "-o", item])
        return [item]

    def test_find_package_in_cxx(self):
        self.execute(self.consumer("package_cxx", "CXX", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                                   f"-Dmdhcal_DIR={self.config()}"))

    def test_find_package_in_c(self):
        self.execute(self.consumer("package_c", "C", f"-Dmdhcal_DIR={self.config()}"))

    def test_find_package_in_parts(self):
        found = [f"-Dmdhcal_DIR={self.config()}"]
        self.execute(self.consumer("package_parts", "CXX", *found, "-DCONSUMER_COMPONENTS=COMPONENTS;rt;port"))
        with self.assertRaisesRegex(AssertionError, "wheels"):
            self.consumer("package_wheels", "CXX", *found, "-DCONSUMER_COMPONENTS=COMPONENTS;wheels")
        if not PRESET:
            self.execute(self.consumer("package_sodium", "CXX", *found, "-DCONSUMER_COMPONENTS=COMPONENTS;port_sodium"))

    def config(self):
        return next(self.prefix.rglob("mdhcalConfig.cmake")).parent

    def test_add_subdirectory(self):
        self.execute(self.consumer("subdirectory_cxx", "CXX", f"-DCONSUMER_SOURCE_TREE={ROOT}"))

    def test_fetch_content_from_a_project_in_c(self):
        self.execute(self.consumer("fetched_c", "C", f"-DCONSUMER_FETCH={ROOT}"))

    def test_nothing_installed_names_a_place(self):
        for path in [*self.prefix.rglob("*.cmake"), *self.prefix.rglob("*.pc")]:
            self.assertNotIn(str(self.here), path.read_text(), path)
            self.assertNotIn(str(ROOT), path.read_text(), path)

    def test_pkg_config(self):
        pc = next(self.prefix.rglob("mdhcal.pc"))
        environment = {**os.environ, "PKG_CONFIG_LIBDIR": str(pc.parent), "PKG_CONFIG_ALLOW_SYSTEM_CFLAGS": "1"}
        options = self.run_(["pkg-config", "--cflags", "--libs", "mdhcal"], env=environment).split()
        program = self.here / "by_pkg_config"
        self.run_([self.prefix_ + "g++", "-std=c++17", *self.flags, HERE / "consumer/consumer.cpp", *self.startup(),
                   *options, *self.link, "-o", program])
        self.execute(program)

    def amalgamated(self):
        """The folder of amalgamate.py, with its objects as a compiler makes them that is told nothing of IEEE arithmetic."""
        folder = self.here / "amalgamated"
        if not folder.exists():
            self.run_([sys.executable, ROOT / "cmake/packaging/amalgamate.py", folder])
            for source in folder.glob("src/*.cpp"):
                self.run_([self.prefix_ + "g++", *self.flags, "-std=c++17", "-O2", "-fno-exceptions", "-fno-math-errno",
                           "-ffunction-sections", "-ffp-contract=fast", f"-I{folder / 'include'}", "-c", source,
                           "-o", source.with_suffix(".o")])
        return folder, sorted(folder.glob("src/*.o"))

    def test_amalgamation_holds_the_same_functions(self):
        folder, objects = self.amalgamated()
        names = lambda files: {line.split()[2] for line in self.run_(
            [self.prefix_ + "nm", "-g", "--defined-only", *files]).splitlines() if len(line.split()) == 3}
        lib, port = names([BUILD / "lib/libmdhcal_rt.a"]), names([BUILD / "port/libmdhcal_port.a"])
        self.assertLessEqual(lib, names(objects))
        self.assertLessEqual(names(objects) - lib, port)
        program = self.here / "by_amalgamation"
        self.run_([self.prefix_ + "g++", "-std=c++17", *self.flags, f"-I{folder / 'include'}",
                   HERE / "consumer/consumer.cpp", *objects, *self.startup(), *self.link, "-o", program])
        self.execute(program)

    def test_amalgamation_has_the_same_bits(self):
        folder, objects = self.amalgamated()
        program = self.here / "loop_by_amalgamation"
        self.run_([self.prefix_ + "gcc", "-std=c99", *self.flags, f"-I{folder / 'include'}", ROOT / "lib/examples/servo_loop.c",
                   *objects, *self.startup(), *self.link, "-o", program])
        # load: ok says that every bit of the self-test is the host tool's.
        done = self.run_([*self.emulator, program, BLOB], timeout=60)
        self.assertRegex(done, r"^load: ok\n(tick \d+: ok, .*\n){4}$")

    def test_platformio_and_esp_idf_take_the_amalgamation(self):
        folder, _ = self.amalgamated()
        library = (ROOT / "lib/CMakeLists.txt").read_text()
        for flag in json.loads((folder / "library.json").read_text())["build"]["flags"]:
            self.assertTrue(flag == "-std=c++17" or f"{flag} " in library or f"{flag})" in library or f"{flag}\n" in library, flag)
        if not PRESET:
            self.execute(self.build("esp_idf", HERE / "esp_idf_like", f"-DMODULE={folder}",
                                    f"-DCONSUMER={HERE / 'consumer/consumer.cpp'}"))

    def zephyr(self, name, application):
        return self.build(name, application, f"-DZephyr_DIR={HERE / 'zephyr_like'}", f"-DEXTRA_ZEPHYR_MODULES={ROOT}",
                          "-DCMAKE_SYSTEM_NAME=Generic", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")

    def test_zephyr_application_in_c(self):
        self.execute(self.zephyr("zephyr_c", HERE / "zephyr_like/c_app"))
        commands = json.loads((self.here / "zephyr_c/compile_commands.json").read_text())
        ours = [entry["command"].split() for entry in commands if "/lib/src/" in entry["file"] or "/port/src/" in entry["file"]]
        self.assertGreater(len(ours), 20)
        for command in ours:  # the last option of a kind is the one that holds
            self.assertIn("-DFROM_ZEPHYR=1", command)
            self.assertIn("-std=c++11", command)
            self.assertEqual([option for option in command if option.startswith("-std=")][-1], "-std=c++17")
        tick = next(command for command in ours if command[-1].endswith("inverse/inverse.cpp"))
        self.assertEqual([option for option in tick if option.startswith("-O")][-1], "-O2")

    def test_zephyr_sample(self):
        program = self.zephyr("zephyr_sample", ROOT / "port/zephyr/sample")
        flash = self.here / "flash.bin"
        environment = {**os.environ, "FLASH": str(flash)}
        empty = subprocess.run([program], capture_output=True, text=True, env=environment, timeout=60)
        self.assertEqual((empty.returncode, empty.stdout), (1, ": no acceptable blob stored\n"))
        # Slot 1 is newer, and damaged: the blob of slot 0 is taken.
        blob = BLOB.read_bytes()
        damaged = blob[:100] + bytes([blob[100] ^ 1]) + blob[101:]
        flash.write_bytes((slot(blob, 7) + slot(damaged, 8)).ljust(32768, b"\xff"))
        done = self.run_([program], env=environment, timeout=60)
        self.assertRegex(done, r"^[^\n]+: ok\n1000 ticks, joint 1 moved to 5\d{5} urad: ok\n$")


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv[1])
    PRESET = sys.argv[2] if len(sys.argv) > 2 and not sys.argv[2].startswith(("-", "Packaging")) else ""
    unittest.main(argv=[sys.argv[0], *sys.argv[2 + bool(PRESET):]], verbosity=2)
