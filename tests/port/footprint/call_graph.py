# SPDX-License-Identifier: MIT
"""The longest path through the call graph that GCC writes with -fcallgraph-info=su: a bound of the stack."""
import functools
import re


class CallGraph:
    def __init__(self, target, image):
        """`image`: a linked image, in whose code the frames of functions without a graph are read (libgcc, newlib)."""
        self.frame, self.calls, self.unbounded = {}, {}, set()
        folders = [target.build / "lib", target.build / "port"]
        files = sorted(path for folder in folders for path in folder.rglob("*.ci"))
        if not files:
            raise SystemExit("no call graph: the library was not compiled with -fcallgraph-info=su")
        texts = {path: path.read_text() for path in files}
        own = {path: set(re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*bytes', text)) for path, text in texts.items()}

        def key(path, title):
            # A function of internal linkage carries its file's name; the same file is compiled once a precision.
            return (str(path), title) if ":" in title else title

        for path, text in texts.items():
            for title, size, kind in re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \((\w+)', text):
                self.frame[key(path, title)] = int(size)
                self.calls.setdefault(key(path, title), set())
                if kind != "static":
                    self.unbounded.add(title)
            for source, callee in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text):
                self.calls.setdefault(key(path, source), set()).add(key(path, callee))
        if target.bare_metal:
            self._read_image(target, image)

    def _read_image(self, target, image):
        # One function may have several names (__aeabi_dadd, __adddf3); the disassembly shows one of them.
        named = {}
        for line in target.tool("nm", image).splitlines():
            words = line.split()
            if len(words) == 3 and words[1] in "Tt":
                named.setdefault(words[0], []).append(words[2])
        name = None
        for line in target.tool("objdump", "-d", image).splitlines():
            begin = re.match(r"[0-9a-f]+ <(.+)>:", line)
            if begin:
                name = begin.group(1)
                self.known = name in self.frame
                if not self.known:
                    self.frame[name] = 0
                    self.calls[name] = set()
                continue
            if name is None or self.known:
                continue
            words = line.split("\t")
            if len(words) < 3:
                continue
            operation, operands = words[2], words[3] if len(words) > 3 else ""
            if re.match(r"v?push|stmdb", operation) and (operation.endswith("push") or operands.startswith("sp!")):
                size = 0
                for low, high in re.findall(r"([rds]\d+|ip|lr|fp|sl|sb|pc)(?:-([rds]\d+))?", operands.split("{")[-1]):
                    count = int(high[1:]) - int(low[1:]) + 1 if high else 1
                    size += count * (8 if low[0] == "d" and low[1:].isdigit() else 4)
                self.frame[name] += size
            elif re.match(r"subw?", operation) and re.match(r"sp, (sp, )?#\d+", operands):
                self.frame[name] += int(re.search(r"#(\d+)", operands).group(1))
            callee = re.search(r"<([^+>]+)>", operands)
            if re.match(r"b", operation) and callee and callee.group(1) != name:
                self.calls[name].add(callee.group(1))
        for names in named.values():
            shown = [name for name in names if name in self.frame]
            for name in names:
                if shown and name not in self.frame:
                    self.frame[name] = self.frame[shown[0]]
                    self.calls[name] = self.calls[shown[0]]

    def bound(self, function):
        """Bytes, and the names that have no bound of their own."""
        unknown = set()

        @functools.lru_cache(maxsize=None)
        def deepest(at):
            if at in active:
                unknown.add(f"recursion through {at}")
                return 0
            if at == "__indirect_call":
                unknown.add("a call through a pointer")
                return 0
            if at not in self.frame:
                unknown.add(at if isinstance(at, str) else at[1].rsplit(":", 1)[-1])
                return 0
            active.add(at)
            below = max((deepest(callee) for callee in self.calls.get(at, ())), default=0)
            active.discard(at)
            return self.frame[at] + below

        active = set()
        return deepest(function), sorted(unknown)
