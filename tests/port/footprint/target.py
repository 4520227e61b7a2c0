# SPDX-License-Identifier: MIT
"""A configured build tree: its compiler, its archives and what binutils say of them."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[3]
MACHINES = {"cortex-m7": "mps2-an500", "cortex-m4f": "mps2-an386", "cortex-m55": "mps3-an547"}


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(str(part) for part in command)}\n{done.stdout}{done.stderr}")
    return done.stdout


class Target:
    def __init__(self, preset, build=None):
        self.preset = preset
        self.build = pathlib.Path(build) if build else ROOT / "build" / preset
        cache = (self.build / "CMakeCache.txt").read_text()
        toolchain = re.search(r"^CMAKE_TOOLCHAIN_FILE:\w+=(.+)$", cache, re.M)
        settings = pathlib.Path(toolchain.group(1)).read_text() if toolchain else ""
        flags = re.search(r'MDHCAL_CPU_FLAGS "(.*)"', settings)
        self.flags = flags.group(1).split() if flags else []
        self.bare_metal = bool(flags)
        known = next(self.build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake")).read_text()
        self.compiler = re.search(r'set\(CMAKE_CXX_COMPILER "(.+)"\)', known).group(1)
        self.prefix = self.compiler[: -len("g++")]
        self.archives = [self.build / "port/libmdhcal_port.a", self.build / "lib/libmdhcal_rt.a"]
        for archive in self.archives:
            if not archive.exists():
                raise SystemExit(f"{archive} is not built: cmake --build build/{preset}")

    def tool(self, name, *arguments):
        return run(self.prefix + name, *arguments)

    def symbols(self):
        """(mangled, demangled) of every function that the archives define for others."""
        listing = self.tool("nm", "--defined-only", "-g", *self.archives)
        mangled = sorted({line.split()[2] for line in listing.splitlines() if re.match(r"[0-9a-f]+ T ", line)})
        names = self.tool("c++filt", *mangled).splitlines()
        return list(zip(mangled, names))

    def public_functions(self):
        """The symbols that a public header declares."""
        headers = [*ROOT.glob("lib/include/mdhcal/*.h*"), *ROOT.glob("port/include/mdhcal/port/*.hpp")]
        text = "\n".join(re.sub(r"//.*", "", header.read_text()) for header in headers)
        declared = set(re.findall(r"\b(\w+)\s*\(", text))
        return [(m, n) for m, n in self.symbols()
                if re.match(r"mdhcalf?_", m) or re.sub(r"\(.*", "", n).split("::")[-1] in declared]

    def link(self, output, roots, *options):
        """An image of what the roots reach and nothing else."""
        keep = [option for root in roots for option in (f"-Wl,-u,{root}",)]
        kind = ["-nostartfiles"] if self.bare_metal else ["-nostdlib", "-r"]
        libraries = ["-Wl,--start-group", *self.archives, *(["-lm", "-lc", "-lgcc"] if self.bare_metal else []), "-Wl,--end-group"]
        run(self.compiler, *self.flags, *kind, "-nostdlib", "-Wl,--gc-sections", f"-Wl,-e,{roots[0]}", *keep, *options,
            *libraries, "-o", output)
        return output

    def sections(self, image):
        """Bytes a kind of section: code and constants, data, bss."""
        total = {"code": 0, "data": 0, "bss": 0}
        for line in self.tool("size", "-A", image).splitlines():
            found = re.match(r"(\.\S+)\s+(\d+)", line)
            if not found:
                continue
            name, size = found.group(1), int(found.group(2))
            if re.match(r"\.(text|rodata|init_array|ARM\.extab|data\.rel\.ro)", name):
                total["code"] += size
            elif re.match(r"\.t?data", name):
                total["data"] += size
            elif re.match(r"\.t?bss", name):
                total["bss"] += size
        return total
